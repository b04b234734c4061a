#!/usr/bin/env node
// Remeshes over gRPC from Node: to use, or to see what a client in any language has to do.
//
//   npm ci --prefix client/node
//   client/node/meshfront_client.mjs HOST:PORT in.ply out.off --rho 0.5
//
// or, in a program:
//
//   const client = new RemeshClient('127.0.0.1:50051');
//   const result = await client.remeshMesh(positions, triangles, {options: {rho: 0.5}});
//   result.positions, result.triangles, result.summary.quality.radiusRatioMedian
//
// Arrays are Float64Array and Uint32Array, in and out. Options are those of proto/meshfront/v1/options.proto, in camelCase.
import crypto from 'node:crypto';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import {fileURLToPath} from 'node:url';
import {parseArgs} from 'node:util';

import grpc from '@grpc/grpc-js';
import protoLoader from '@grpc/proto-loader';
import CRC32C from 'crc-32/crc32c.js';

const BLOCK_BYTES = 1 << 18;
const MOST_SECONDS = 1e6; // timers take no more
const MESSAGE_BYTES = 4 << 20; // chunks of up to 1 MiB and what is around them

const protoFolder = process.env.MESHFRONT_PROTO ?? path.resolve(path.dirname(fileURLToPath(import.meta.url)), '../../proto');
const definition = protoLoader.loadSync('meshfront/v1/remesh_service.proto',
                                        {includeDirs: [protoFolder], enums: String, longs: Number, oneofs: true, defaults: true});
const {MeshfrontService} = grpc.loadPackageDefinition(definition).meshfront.v1;

export const crc32c = (bytes, crc = 0) => CRC32C.buf(bytes, crc) >>> 0;

/**
 * The server refused, or the call failed. `code`: one of grpc.status. `reason`: why, for programs, in UPPER_SNAKE (SESSION_CHANGED,
 * OUT_OF_MEMORY, …), and `metadata`: an object that says where; both empty where no server of ours says so, as where there is none.
 */
export class RemeshError extends Error {
  constructor(error) {
    super(`${grpc.status[error.code] ?? error.code}: ${error.details ?? error.message}`);
    this.name = 'RemeshError';
    this.code = error.code;
    const [details] = error.metadata?.get('grpc-status-details-bin') ?? [];
    Object.assign(this, reasonOf(details ?? Buffer.alloc(0)));
  }
}

/** What came back is not what was sent: a checksum, a number or a count is wrong. */
export class DamagedError extends Error {}

/** Calls one server. */
export class RemeshClient {
  /** `target`: HOST:PORT. `credentials`: grpc.credentials.createSsl(…) for a server with TLS. */
  constructor(target, credentials = grpc.credentials.createInsecure()) {
    this.stub = new MeshfrontService(target, credentials, {'grpc.max_receive_message_length': MESSAGE_BYTES});
  }

  close() {
    this.stub.close();
  }

  /** What the server can do and allows. */
  capabilities({timeout} = {}) {
    return new Promise((resolve, reject) => this.stub.getCapabilities(
      {}, deadlineOf(timeout), (error, response) => error ? reject(new RemeshError(error)) : resolve(response)));
  }

  /** Remeshes an indexed mesh. The last argument: see call. */
  remeshMesh(positions, triangles, settings) {
    expectThrees(positions, Float64Array, 'positions');
    expectThrees(triangles, Uint32Array, 'triangles');
    const mesh = {vertexCount: positions.length / 3, triangleCount: triangles.length / 3, scalarType: 'SCALAR_TYPE_FLOAT64'};
    return this.call({mesh}, [['ARRAY_POSITIONS', bytesOf(positions)], ['ARRAY_TRIANGLES', bytesOf(triangles)]], settings);
  }

  /** Meshes a point set, with outward normals or with null. The last argument: see call. */
  remeshPoints(positions, normals, settings) {
    expectThrees(positions, Float64Array, 'positions');
    const arrays = [['ARRAY_POSITIONS', bytesOf(positions)]];
    if (normals) {
      expectThrees(normals, Float64Array, 'normals');
      if (normals.length !== positions.length) throw new RangeError(`${normals.length / 3} normals for ${positions.length / 3} points`);
      arrays.push(['ARRAY_NORMALS', bytesOf(normals)]);
    }
    const points = {pointCount: positions.length / 3, scalarType: 'SCALAR_TYPE_FLOAT64', hasNormals: Boolean(normals)};
    return this.call({points}, arrays, settings);
  }

  /** Remeshes what is in a file (OFF, OBJ, PLY, STL, GLB, glTF, XYZ), which the server reads. The last argument: see call. */
  remeshFile(name, data, settings) {
    return this.call({file: {name: path.basename(name), sizeBytes: data.length}}, [['ARRAY_FILE', data]], settings);
  }

  /**
   * Remeshes the mesh that the server keeps as summary.session.id. settings: see call, and sessionRevision: rejects (with the reason
   * SESSION_CHANGED) where the session's mesh has another one. With it an update may be sent again whose answer was lost: it is not made
   * twice.
   */
  remeshSession(sessionId, {sessionRevision, ...settings} = {}) {
    const revision = sessionRevision === undefined ? {} : {sessionRevision};
    return this.call({sessionId, ...revision}, [], settings);
  }

  /**
   * Resolves to {positions, triangles, removed, summary, warnings, complete}; where complete is false, summary.openPlaces says where it
   * is not whole; removed: faces of the input that a patch (region.patchOnly) takes the place of. Rejects with RemeshError,
   * DamagedError, or what onProgress throws; the server ends the job then.
   *
   * settings: {options, timeout: seconds, onProgress: (triangles, predictedTriangles) => …, signal: an AbortSignal,
   *            regionFaces: a Uint32Array of faces to remesh, keepSession: the server keeps the mesh for remeshSession,
   *            updateSession: with that or of a session, the result takes the place of the mesh that is kept; its faces are the input's
   *            but for the removed ones, then the new ones}
   */
  call(header, arrays, {options = {}, timeout, onProgress, signal, regionFaces, keepSession = false, updateSession = false} = {}) {
    expectOptions(options);
    if (regionFaces) {
      if (!(regionFaces instanceof Uint32Array)) throw new TypeError('regionFaces must be a Uint32Array');
      options = {...options, region: {...options.region, faceCount: regionFaces.length}};
      arrays = [...arrays, ['ARRAY_REGION_FACES', bytesOf(regionFaces)]];
    }
    const stream = this.stub.remesh(deadlineOf(timeout));
    return new Promise((resolve, reject) => {
      const collected = new Collected();
      const fail = (error) => {
        reject(error);
        stream.cancel();
      };
      signal?.addEventListener('abort', () => stream.cancel(), {once: true});
      if (signal?.aborted) stream.cancel();
      stream.on('data', (response) => {
        try {
          collected.take(response.event);
          onProgress?.(collected.triangleCount, collected.predicted);
        } catch (error) {
          fail(error);
        }
      });
      stream.on('error', (error) => fail(new RemeshError(error)));
      stream.on('end', () => {
        try {
          resolve(collected.result());
        } catch (error) {
          fail(error);
        }
      });
      send(stream, {...header, options, keepSession, updateSession, output: {scalarType: 'SCALAR_TYPE_FLOAT64'}}, arrays).catch(fail);
    });
  }
}

/** [number, bytes] of each field of a Protobuf message that has a length; the others are passed over. */
function fieldsOf(message) {
  const fields = [];
  let at = 0;
  const varint = () => {
    let value = 0;
    for (let scale = 1; ; scale *= 128) {
      if (at >= message.length) throw new DamagedError('a message ends too early');
      const byte = message[at++];
      value += (byte & 127) * scale;
      if (byte < 128) return value;
    }
  };
  while (at < message.length) {
    const key = varint(), kind = key & 7;
    if (kind === 0) {
      varint();
      continue;
    }
    const size = {1: 8, 5: 4}[kind] ?? varint();
    if (kind === 2) fields.push([Math.floor(key / 8), message.subarray(at, at + size)]);
    at += size;
  }
  return fields;
}

/** Of the google.rpc.ErrorInfo in a google.rpc.Status; nothing where there is none, or the bytes are damaged. */
function reasonOf(details) {
  const text = (fields, wanted) => fields.findLast(([number]) => number === wanted)?.[1].toString() ?? '';
  const all = (fields, wanted) => fields.filter(([number]) => number === wanted).map(([, bytes]) => fieldsOf(bytes));
  try {
    const info = all(fieldsOf(details), 3).find((any) => text(any, 1).endsWith('/google.rpc.ErrorInfo'));
    if (!info) return {reason: '', metadata: {}};
    const fields = fieldsOf(info.findLast(([number]) => number === 2)?.[1] ?? Buffer.alloc(0));
    return {reason: text(fields, 1), metadata: Object.fromEntries(all(fields, 3).map((entry) => [text(entry, 1), text(entry, 2)]))};
  } catch (error) {
    if (error instanceof DamagedError) return {reason: '', metadata: {}};
    throw error;
  }
}

function deadlineOf(timeout) {
  if (timeout === undefined || timeout === null) return {};
  if (typeof timeout !== 'number' || !(timeout >= 0)) throw new RangeError(`timeout is ${timeout}; it is a number of seconds`);
  return {deadline: Date.now() + 1000 * Math.min(timeout, MOST_SECONDS)};
}

const optionFields = new Set(definition['meshfront.v1.RemeshOptions'].type.field.map((field) => camelCase(field.name)));

function camelCase(name) {
  return name.replace(/_(\w)/g, (_, letter) => letter.toUpperCase());
}

/** What the library would leave out without a word. */
function expectOptions(options) {
  for (const name of Object.keys(options)) {
    if (!optionFields.has(name)) throw new RangeError(`there is no option ${name}; there are ${[...optionFields].join(', ')}`);
  }
}

function expectThrees(array, type, name) {
  if (!(array instanceof type)) throw new TypeError(`${name} must be a ${type.name}`);
  if (array.length === 0 || array.length % 3 !== 0) throw new RangeError(`${name} has ${array.length} numbers; it takes three each`);
}

function bytesOf(array) {
  if (os.endianness() !== 'LE') throw new Error('arrays are sent as they lie in memory, which has to be little-endian');
  return Buffer.from(array.buffer, array.byteOffset, array.byteLength);
}

/** Header, blocks, end: what the server wants, in the order that it wants it; no faster than it reads. */
async function send(stream, header, arrays) {
  let ended = false;
  const over = new Promise((resolve) => stream.once('close', resolve).once('error', resolve).once('end', resolve)).then(() => { ended = true; });
  const write = async (message) => {
    if (!ended && !stream.write(message)) await Promise.race([new Promise((resolve) => stream.once('drain', resolve)), over]);
  };
  await write({header});
  const digest = crypto.createHash('sha256');
  for (const [array, bytes] of arrays) {
    for (let offset = 0; offset < bytes.length && !ended; offset += BLOCK_BYTES) {
      const data = bytes.subarray(offset, offset + BLOCK_BYTES);
      digest.update(data);
      await write({block: {array, offset, data, crc32c: crc32c(data)}});
    }
  }
  await write({end: {sha256: digest.digest()}});
  if (!ended) stream.end();
}

/** What has come back so far. */
export class Collected {
  positions = [];
  triangles = [];
  removed = [];
  warnings = [];
  vertexCount = 0;
  triangleCount = 0;
  predicted = 0;
  summary = null;

  take(event) {
    if (event.event === 'chunk') this.takeChunk(event.chunk);
    else if (event.event === 'progress') this.predicted = event.progress.predictedTriangles;
    else if (event.event === 'removed') this.takeRemoved(event.removed);
    else if (event.event === 'defect') this.warnings.push(event.defect.message);
    else if (event.event === 'summary') this.summary = event.summary;
  }

  takeChunk(chunk) {
    const number = this.positions.length;
    // All bytes fields, in the order of their numbers.
    const crc = [chunk.positions, chunk.normals, chunk.indices, chunk.finalised, chunk.wedgeValues, chunk.cornerWedges, chunk.groups]
      .reduce((sum, bytes) => crc32c(bytes, sum), 0);
    if (chunk.crc32c !== crc || chunk.sequence !== number || chunk.firstVertex !== this.vertexCount)
      throw new DamagedError(`chunk ${number} is not what was sent`);
    if (chunk.positions.length !== 24 * chunk.vertexCount || chunk.indices.length !== 12 * chunk.triangleCount)
      throw new DamagedError(`chunk ${number} has other arrays than it says`);
    this.positions.push(chunk.positions);
    this.triangles.push(chunk.indices);
    this.vertexCount += chunk.vertexCount;
    this.triangleCount += chunk.triangleCount;
  }

  takeRemoved({faces, crc32c: sum}) {
    if (crc32c(faces) !== sum) throw new DamagedError('a list of removed faces is not what was sent');
    this.removed.push(faces);
  }

  result() {
    if (!this.summary || this.summary.chunks !== this.positions.length)
      throw new DamagedError('the stream ended without its summary, or chunks are missing: the mesh is not whole');
    const joined = (parts) => Uint8Array.from(Buffer.concat(parts)).buffer; // aligned
    const removed = new Uint32Array(joined(this.removed)), removedCount = this.summary.region?.removedFaces ?? 0;
    if (removed.length !== removedCount) throw new DamagedError(`${removed.length} removed faces came; there are ${removedCount}`);
    return {
      positions: new Float64Array(joined(this.positions)),
      triangles: new Uint32Array(joined(this.triangles)),
      removed,
      summary: this.summary,
      warnings: [...this.warnings, ...this.summary.warnings],
      complete: this.summary.complete,
    };
  }
}

/** Writes the mesh aside and renames it, so that a file that was there is whole at any time. */
export function writeOff(file, {positions, triangles}) {
  const lines = [`OFF\n${positions.length / 3} ${triangles.length / 3} 0`];
  for (let i = 0; i < positions.length; i += 3) lines.push(`${positions[i]} ${positions[i + 1]} ${positions[i + 2]}`);
  for (let i = 0; i < triangles.length; i += 3) lines.push(`3 ${triangles[i]} ${triangles[i + 1]} ${triangles[i + 2]}`);
  if (fs.existsSync(file) && !fs.statSync(file).isFile()) throw new Error(`${file} is no regular file`);
  fs.writeFileSync(`${file}.part`, `${lines.join('\n')}\n`);
  fs.renameSync(`${file}.part`, file);
}

async function main() {
  const usage = 'usage: meshfront_client.mjs HOST:PORT IN OUT.off [--rho R | --target-triangles N] [--timeout SECONDS]';
  let values, positionals;
  try {
    ({values, positionals} = parseArgs({
      allowPositionals: true,
      options: {'rho': {type: 'string'}, 'target-triangles': {type: 'string'}, 'timeout': {type: 'string'}, 'help': {type: 'boolean'}},
    }));
  } catch (error) {
    console.error(`meshfront_client: ${error.message}\n${usage}`);
    return 2;
  }
  if (values.help || positionals.length !== 3) {
    (values.help ? console.log : console.error)(usage);
    return values.help ? 0 : 2;
  }
  const [server, input, output] = positionals;
  const numbers = {};
  for (const name of ['rho', 'target-triangles', 'timeout']) {
    if (values[name] === undefined) continue;
    numbers[name] = values[name].trim() === '' ? NaN : Number(values[name]);
    const isWhole = name !== 'target-triangles' || (Number.isSafeInteger(numbers[name]) && numbers[name] > 0);
    if (Number.isNaN(numbers[name]) || !isWhole) {
      console.error(`meshfront_client: --${name} is ${values[name]}\n${usage}`);
      return 2;
    }
  }
  const giveUp = (code, error) => {
    console.error(`meshfront_client: ${error.message}`);
    return code;
  };
  let data, client, result; // the program's exit codes
  try {
    data = fs.readFileSync(input);
  } catch (error) {
    return giveUp(3, error);
  }
  try {
    client = new RemeshClient(server);
    const options = {};
    if ('rho' in numbers) options.rho = numbers.rho;
    if ('target-triangles' in numbers) options.targetTriangles = numbers['target-triangles'];
    result = await client.remeshFile(input, data, {
      options,
      timeout: numbers.timeout,
      onProgress: (triangles, predicted) => process.stderr.isTTY && process.stderr.write(`\r${triangles} of about ${predicted} triangles`),
    });
  } catch (error) {
    if (error instanceof RemeshError) return giveUp(EXIT_CODES[grpc.status[error.code]] ?? 70, error);
    return giveUp(error instanceof RangeError ? 2 : 5, error);
  } finally {
    client?.close();
  }
  for (const warning of result.warnings) console.error(`warning: ${warning}`);
  try {
    writeOff(output, result);
  } catch (error) {
    return giveUp(7, error);
  }
  const {radiusRatioMin, radiusRatioMedian} = result.summary.quality;
  console.log(`${result.triangles.length / 3} triangles, 2r/R ${radiusRatioMin.toFixed(3)} at least, ${radiusRatioMedian.toFixed(3)} in the middle`);
  return result.complete ? 0 : 4;
}

const EXIT_CODES = {INVALID_ARGUMENT: 2, FAILED_PRECONDITION: 3, UNAVAILABLE: 5, RESOURCE_EXHAUSTED: 5, CANCELLED: 6, DEADLINE_EXCEEDED: 6};

if (process.argv[1] && fs.realpathSync(process.argv[1]) === fileURLToPath(import.meta.url)) process.exitCode = await main();
