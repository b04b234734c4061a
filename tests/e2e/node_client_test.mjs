// Run by run_node, beside a copy of the client: MESHFRONTD and MESHFRONT name the programs.
import assert from 'node:assert/strict';
import {execFileSync, spawn, spawnSync} from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import readline from 'node:readline';
import {after, before, test} from 'node:test';

import grpc from '@grpc/grpc-js';

import {Collected, DamagedError, RemeshClient, RemeshError, crc32c, writeOff} from './meshfront_client.mjs';

/** A torus of radii 1 and 0.4. */
function torus(around, along) {
  const positions = [], triangles = [];
  for (let i = 0; i < around; ++i) {
    for (let j = 0; j < along; ++j) {
      const u = 2 * Math.PI * i / around, v = 2 * Math.PI * j / along, radius = 1 + 0.4 * Math.cos(v);
      positions.push(radius * Math.cos(u), radius * Math.sin(u), 0.4 * Math.sin(v));
      const next = (i + 1) % around;
      const a = i * along + j, b = next * along + j, c = next * along + (j + 1) % along, d = i * along + (j + 1) % along;
      triangles.push(a, b, c, a, c, d);
    }
  }
  return [Float64Array.from(positions), Uint32Array.from(triangles)];
}

/** Whether every edge is run through once in each direction. */
function isClosed(triangles) {
  const edges = new Set();
  for (let i = 0; i < triangles.length; i += 3) {
    for (let k = 0; k < 3; ++k) {
      const edge = `${triangles[i + k]} ${triangles[i + (k + 1) % 3]}`;
      if (edges.has(edge)) return false;
      edges.add(edge);
    }
  }
  return [...edges].every((edge) => edges.has(edge.split(' ').reverse().join(' ')));
}

let server, address, client, folder;

before(async () => {
  server = spawn(process.env.MESHFRONTD, ['--listen', '127.0.0.1:0'], {stdio: ['ignore', 'ignore', 'pipe']});
  const lines = readline.createInterface({input: server.stderr});
  address = await new Promise((resolve, reject) => {
    lines.once('line', (line) => line.includes('listening on') ? resolve(line.split(' ').at(-1)) : reject(new Error(line)));
  });
  client = new RemeshClient(address);
  folder = fs.mkdtempSync(path.join(os.tmpdir(), 'meshfront-node-'));
});

after(() => {
  client.close();
  server.kill();
  fs.rmSync(folder, {recursive: true});
});

test('gives the mesh that the program gives', async () => {
  const [positions, triangles] = torus(48, 24);
  let seen = [];
  const result = await client.remeshMesh(positions, triangles, {options: {rho: 0.6}, onProgress: (...at) => { seen = at; }});
  assert.ok(result.complete);
  assert.ok(isClosed(result.triangles));
  assert.equal(seen[0], result.triangles.length / 3);
  assert.ok(seen[1] > 0);
  const source = path.join(folder, 'in.off'), out = path.join(folder, 'out.off');
  writeOff(source, {positions, triangles});
  execFileSync(process.env.MESHFRONT, ['remesh', source, out, '--rho', '0.6', '--quiet']);
  const numbers = fs.readFileSync(out, 'utf8').trim().split(/\s+/).slice(1).map(Number);
  assert.deepEqual(numbers.slice(0, 2), [result.positions.length / 3, result.triangles.length / 3]);
  assert.deepEqual(numbers.slice(3, 3 + result.positions.length), [...result.positions]);
  const byFile = await client.remeshFile('in.off', fs.readFileSync(source), {options: {rho: 0.6}});
  assert.deepEqual(byFile.triangles, result.triangles);
});

test('meshes points', async () => {
  const [positions] = torus(90, 60);
  const normals = positions.map((x, i) => {
    const at = i - i % 3, ring = Math.hypot(positions[at], positions[at + 1]);
    return i % 3 === 2 ? x : x - x / ring;
  });
  const result = await client.remeshPoints(positions, normals);
  assert.ok(result.complete);
  assert.ok(isClosed(result.triangles));
  assert.throws(() => client.remeshPoints(positions, normals.subarray(3)), RangeError);
});

test('lets patches accumulate in a session', async () => {
  const [positions, triangles] = torus(96, 48);
  const region = {sphere: {center: {x: 1.4}, radius: 0.3}};
  const whole = await client.remeshMesh(positions, triangles, {options: {rho: 0.5, region}});
  const count = whole.triangles.length / 3, kept = count - whole.summary.region.newTriangles;
  const regionFaces = Uint32Array.from({length: count - kept}, (_, i) => kept + i); // what is new
  const options = {rho: 0.2, region: {patchOnly: true}};
  const twice = await client.remeshMesh(whole.positions, whole.triangles, {options, regionFaces});
  const first = await client.remeshMesh(positions, triangles, {
    options: {rho: 0.5, region: {...region, patchOnly: true}}, keepSession: true, updateSession: true});
  assert.equal(first.removed.length, triangles.length / 3 - kept);
  const {id, revision} = first.summary.session;
  const second = await client.remeshSession(id, {sessionRevision: revision, options, regionFaces, updateSession: true});
  assert.deepEqual([second.positions, second.triangles], [twice.positions, twice.triangles]);
  assert.deepEqual([second.removed, twice.removed], [regionFaces, regionFaces]);
  // Sent again, as if the answer had been lost: it is told apart from what may be tried again, and not made twice.
  const isLate = (error) => error instanceof RemeshError && error.code === grpc.status.ABORTED && error.reason === 'SESSION_CHANGED' &&
    error.metadata.revision === `${revision + 1}`;
  await assert.rejects(client.remeshSession(id, {sessionRevision: revision, options, regionFaces, updateSession: true}), isLate);
  const after = await client.remeshSession(id, {sessionRevision: revision + 1, options, regionFaces});
  assert.equal(after.summary.session.revision, revision + 1);
  await assert.rejects(client.remeshSession('0123'), (error) => error.code === grpc.status.NOT_FOUND && error.reason === 'SESSION_UNKNOWN');
  assert.throws(() => client.remeshSession(id, {options, regionFaces: [1]}), TypeError);
});

test('says what the server refuses', async () => {
  const [positions, triangles] = torus(8, 6);
  const isRefusal = (error) => error instanceof RemeshError && error.code === grpc.status.INVALID_ARGUMENT;
  await assert.rejects(client.remeshMesh(positions, triangles, {options: {rho: 9}}), (e) => isRefusal(e) && e.message.includes('rho'));
  triangles[0] = 1000;
  await assert.rejects(client.remeshMesh(positions, triangles), isRefusal);
  assert.throws(() => client.remeshMesh(positions.subarray(1), triangles), RangeError);
  assert.throws(() => client.remeshMesh([0, 0, 0], triangles), TypeError);
  assert.throws(() => client.remeshMesh(positions, triangles, {options: {roh: 0.5}}), /roh/, 'the library would ignore it');
  assert.throws(() => client.remeshMesh(positions, triangles, {options: {target_triangles: 50}}), /target_triangles/);
  for (const timeout of [NaN, -1, '3']) assert.throws(() => client.remeshMesh(positions, triangles, {timeout}), RangeError, `${timeout}`);
});

test('ends at its deadline, by a signal, and by an exception of the caller', async () => {
  const [positions, triangles] = torus(48, 24);
  const endsWith = (code) => (error) => error instanceof RemeshError && error.code === code;
  await assert.rejects(client.remeshMesh(positions, triangles, {options: {rho: 0.01}, timeout: 0.5}), endsWith(grpc.status.DEADLINE_EXCEEDED));
  const abort = new AbortController();
  setTimeout(() => abort.abort(), 200);
  await assert.rejects(client.remeshMesh(positions, triangles, {options: {rho: 0.01}, signal: abort.signal}), endsWith(grpc.status.CANCELLED));
  const stop = () => { throw new Error('enough'); };
  await assert.rejects(client.remeshMesh(positions, triangles, {options: {rho: 0.05}, onProgress: stop}), /enough/);
  assert.ok((await client.remeshMesh(positions, triangles, {timeout: 1e12})).complete, 'the server goes on');
});

test('says that there is no server', async () => {
  const gone = new RemeshClient('127.0.0.1:1');
  await assert.rejects(gone.capabilities({timeout: 5}), (e) => e instanceof RemeshError && e.code === grpc.status.UNAVAILABLE && e.reason === '');
  gone.close();
  assert.ok((await client.capabilities({timeout: 30})).supportedOptions.includes('options.rho'));
});

test('sees damage', () => {
  const none = Buffer.alloc(0);
  const chunk = {sequence: 0, firstVertex: 0, vertexCount: 1, triangleCount: 0, positions: Buffer.alloc(24), normals: none, indices: none,
                 finalised: none, wedgeValues: none, cornerWedges: none, groups: none, crc32c: crc32c(Buffer.alloc(24))};
  new Collected().takeChunk(chunk);
  for (const change of [{crc32c: 1}, {sequence: 1}, {firstVertex: 1}, {vertexCount: 2}, {indices: Buffer.alloc(12)}])
    assert.throws(() => new Collected().takeChunk({...chunk, ...change}), DamagedError, JSON.stringify(change));
  assert.throws(() => new Collected().result(), DamagedError);
});

test('sees reasons in what may be damaged', () => {
  const withLength = (key, bytes) => Buffer.concat([Buffer.from([key, bytes.length]), bytes]);
  const info = Buffer.concat([withLength(0x0a, Buffer.from('WHY')),
                              withLength(0x1a, Buffer.concat([withLength(0x0a, Buffer.from('k')), withLength(0x12, Buffer.from('v'))]))]);
  const any = Buffer.concat([withLength(0x0a, Buffer.from('type.googleapis.com/google.rpc.ErrorInfo')), withLength(0x12, info)]);
  const details = Buffer.concat([Buffer.from([0x08, 0x0a]), withLength(0x1a, any)]);
  const errorOf = (bytes) => new RemeshError({code: 10, details: 'no', metadata: {get: () => [bytes]}});
  assert.deepEqual([errorOf(details).reason, errorOf(details).metadata], ['WHY', {k: 'v'}]);
  for (let at = 0; at < details.length; ++at) {
    assert.equal(errorOf(details.subarray(0, at)).code, 10);
    assert.equal(errorOf(details.map((byte, i) => i === at ? byte ^ 0xff : byte)).code, 10);
  }
  assert.deepEqual(errorOf(undefined).metadata, {});
});

test('is a program too', () => {
  const program = path.join(path.dirname(new URL(import.meta.url).pathname), 'meshfront_client.mjs');
  const source = path.join(folder, 'small.off'), out = path.join(folder, 'small.out.off');
  const [positions, triangles] = torus(24, 12);
  writeOff(source, {positions, triangles});
  const run = (...flags) => spawnSync(process.execPath, [program, address, source, out, ...flags], {encoding: 'utf8'});
  const done = run('--target-triangles', '2000');
  assert.deepEqual([done.status, done.stderr], [0, '']);
  assert.ok(Math.abs(parseInt(done.stdout, 10) / 2000 - 1) < 0.05, done.stdout);
  const before = fs.readFileSync(out);
  const refused = run('--rho', '9');
  assert.equal(refused.status, 2);
  assert.match(refused.stderr, /rho/);
  assert.deepEqual(fs.readFileSync(out), before, 'what was there stays');
  for (const flags of [['--nonsense'], ['--timeout', 'abc'], ['--rho='], ['--target-triangles', '1.5']]) assert.equal(run(...flags).status, 2, flags);
  const runOn = (...positionals) => spawnSync(process.execPath, [program, ...positionals], {encoding: 'utf8'});
  assert.equal(runOn(address, folder, out).status, 3);
  assert.equal(runOn(address, source, folder).status, 7);
  assert.equal(runOn(address, source, path.join(folder, 'none', 'out.off')).status, 7);
  assert.ok(!fs.existsSync(`${folder}.part`));
});
