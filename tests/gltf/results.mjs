// node results.mjs MESHFRONT FOLDER: remeshes a model that has everything, and a few that have little, and has the results validated.
// No errors and no warnings; what the validator does not know (MSFT_lod) it only mentions. Exit 1 says which result is wrong, and how.
import {execFileSync} from 'node:child_process';
import {readFileSync, writeFileSync} from 'node:fs';
import {createRequire} from 'node:module';
import path from 'node:path';

import {glb, jsonOf, model} from './model.mjs';

const [meshfront, folder] = process.argv.slice(2);
const {validateBytes} = createRequire(path.join(folder, 'package.json'))('gltf-validator');
const file = name => path.join(folder, name);
let failures = 0;

function expect(holds, what) {
  if (holds) return;
  ++failures;
  console.error(`FAILED: ${what}`);
}

async function complaintsOf(name) {
  const {issues} = await validateBytes(new Uint8Array(readFileSync(file(name))), {uri: name});
  return issues.messages.filter(m => m.severity < 2).map(m => `${m.code} at ${m.pointer}: ${m.message}`).slice(0, 5);
}

// Runs meshfront, has the result validated, and returns its JSON.
async function result(words) {
  const name = words.find(w => w.startsWith('out_'));
  try {
    execFileSync(meshfront, words.map(w => /^(in|out)_/.test(w) ? file(w) : w), {stdio: ['ignore', 'ignore', 'pipe'], timeout: 60000});
  } catch (error) {
    expect(false, `meshfront ${words.join(' ')}: ${error.stderr}`);
    return null;
  }
  const complaints = await complaintsOf(name);
  expect(complaints.length === 0, `meshfront ${words.join(' ')}\n  ${complaints.join('\n  ')}`);
  return jsonOf(readFileSync(file(name)));
}

const targetsOf = json => json.meshes.flatMap(mesh => mesh.primitives.map(p => p.targets?.length ?? 0));

writeFileSync(file('in_all.glb'), model());
expect((await complaintsOf('in_all.glb')).length === 0, `the model itself: ${await complaintsOf('in_all.glb')}`);

const all = await result(['remesh', 'in_all.glb', 'out_all.glb', '--rho', '0.5']);
expect(all && targetsOf(all).join() === '3,3', 'both primitives have all three morph targets');
expect(all?.skins?.length === 1 && all.animations[0].channels.length === 2, 'the skin and both animations are there');
await result(['remesh', 'in_all.glb', 'out_all.gltf', '--rho', '0.5']);
const levels = await result(['remesh', 'in_all.glb', 'out_lod.glb', '--lod', '0.4,0.8']);
expect(levels && targetsOf(levels).join() === '3,3,3,3', 'every level has all morph targets');
expect(levels?.animations[0].channels.length === 3, 'the weights of every level are animated');
const sphere = ['--region', 'sphere:1,0,0.5,0.8'];
const region = await result(['remesh', 'in_all.glb', 'out_region.glb', '--rho', '0.4', ...sphere]);
expect(region && targetsOf(region).join() === '3,3', 'a region keeps the morph targets');
await result(['remesh', 'in_all.glb', 'out_patch.glb', '--rho', '0.4', ...sphere, '--patch-only']);
const bare = await result(['remesh', 'in_all.glb', 'out_bare.glb', '--attributes', 'drop']);
expect(bare && targetsOf(bare).join() === '0', 'the shape alone has no morph targets');

// Other formats: a shape without anything, texture coordinates and materials of an OBJ, numbers and colours of a PLY's vertices.
execFileSync(meshfront, ['sample', file('in_sample.ply')], {stdio: 'ignore'});
await result(['remesh', 'in_sample.ply', 'out_plain.glb', '--rho', '1']);
const tetrahedron = ['0 0 0', '1 0 0', '0 1 0', '0 0 1'], faces = ['0 2 1', '0 1 3', '1 2 3', '2 0 3'];
writeFileSync(file('in_textured.obj'), [
  ...tetrahedron.map(p => `v ${p}`), 'vt 0 0', 'vt 1 0', 'vt 0 1',
  ...faces.map((f, i) => `usemtl m${i % 2}\nf ${f.split(' ').map((v, k) => `${+v + 1}/${k + 1}`).join(' ')}`), ''
].join('\n'));
await result(['remesh', 'in_textured.obj', 'out_textured.glb', '--edge-length', '0.3']);
writeFileSync(file('in_numbers.ply'), [
  'ply', 'format ascii 1.0', 'element vertex 4', ...['x', 'y', 'z', 'quality'].map(n => `property float ${n}`),
  ...['red', 'green', 'blue'].map(n => `property uchar ${n}`), 'element face 4', 'property list uchar int vertex_indices',
  'end_header', ...tetrahedron.map((p, i) => `${p} ${i} ${60 * i} 0 255`), ...faces.map(f => `3 ${f}`), ''
].join('\n'));
await result(['remesh', 'in_numbers.ply', 'out_numbers.glb', '--edge-length', '0.3']);

// The test of the test: a file with wrong bounds is complained of.
if (all) {
  const bytes = readFileSync(file('out_all.glb')), broken = jsonOf(bytes);
  broken.accessors[broken.meshes[0].primitives[0].targets[0].POSITION].max[0] += 1;
  writeFileSync(file('broken.glb'), glb(broken, bytes.subarray(20 + bytes.readUInt32LE(12) + 8)));
  expect((await complaintsOf('broken.glb')).length > 0, 'the validator sees that bounds are wrong');
}
console.log(failures === 0 ? 'all results are valid' : `${failures} failed`);
process.exitCode = failures === 0 ? 0 : 1;
