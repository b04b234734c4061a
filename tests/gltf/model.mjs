// A model that has everything which can go wrong: a drum with two materials, a texture seam, tangents, colours, an image, a skin with
// its animation, and three morph targets, one of them sparse and one that does nothing, whose weights are animated.

// The smallest image there is: one grey pixel.
const pixel = Buffer.from(
  'iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mNsaGj4DwAFhAKBvxWTQwAAAABJRU5ErkJggg==', 'base64');

// The buffer, and what describes it.
class Writer {
  chunks = [];
  bytes = 0;
  views = [];
  accessors = [];

  view(data, target) {
    const bytes = Buffer.from(data.buffer, data.byteOffset, data.byteLength);
    this.views.push({buffer: 0, byteOffset: this.bytes, byteLength: bytes.length, ...(target ? {target} : {})});
    const padding = Buffer.alloc((4 - bytes.length % 4) % 4);
    this.chunks.push(bytes, padding);
    this.bytes += bytes.length + padding.length;
    return this.views.length - 1;
  }
  array(rows, {bounds = false, integers, target = 34962, matrix = false} = {}) {
    const count = rows.length, size = rows[0].length, numbers = rows.flat();
    const data = integers === 'u16' ? new Uint16Array(numbers) : new Float32Array(numbers);
    const type = matrix ? 'MAT4' : ['SCALAR', 'VEC2', 'VEC3', 'VEC4'][size - 1];
    const accessor = {bufferView: this.view(data, target), componentType: integers ? 5123 : 5126, count, type};
    this.accessors.push(bounds ? {...accessor, ...boundsOf([...data], size)} : accessor);
    return this.accessors.length - 1;
  }
  sparse(count, places, rows) {
    const values = new Float32Array(rows.flat());
    this.accessors.push({
      componentType: 5126, count, type: 'VEC3', ...boundsOf([0, 0, 0, ...values], 3),
      sparse: {
        count: places.length,
        indices: {bufferView: this.view(new Uint16Array(places)), componentType: 5123},
        values: {bufferView: this.view(values)}
      }
    });
    return this.accessors.length - 1;
  }
}

function boundsOf(numbers, size) {
  const columns = Array.from({length: size}, (_, c) => numbers.filter((_, i) => i % size === c));
  return {min: columns.map(c => Math.min(...c)), max: columns.map(c => Math.max(...c))};
}

// Rows of vertices along z, the last of each the first one again: there the texture has its seam.
function wall(columns, rows) {
  const vertices = [], faces = [];
  for (let row = 0; row <= rows; ++row) {
    for (let column = 0; column <= columns; ++column) {
      const angle = 2 * Math.PI * (column % columns) / columns, c = Math.cos(angle), s = Math.sin(angle);
      vertices.push({position: [c, s, 2 * row / rows - 1], normal: [c, s, 0], tangent: [-s, c, 0, 1],
                     texcoord: [column / columns, row / rows], height: row / rows});
      if (row === rows || column === columns) continue;
      const first = row * (columns + 1) + column;
      faces.push([first, first + 1, first + columns + 2], [first, first + columns + 2, first + columns + 1]);
    }
  }
  return {vertices, faces};
}

// A lid of rings around its middle.
function lid(columns, rings) {
  const at = (x, y) => ({position: [x, y, 1], normal: [0, 0, 1], tangent: [1, 0, 0, 1], texcoord: [(x + 1) / 2, (y + 1) / 2],
                         height: 1});
  const vertices = [at(0, 0)], faces = [];
  for (let ring = 1; ring <= rings; ++ring) {
    for (let column = 0; column < columns; ++column) {
      const angle = 2 * Math.PI * column / columns, radius = ring / rings;
      vertices.push(at(radius * Math.cos(angle), radius * Math.sin(angle)));
      const outer = 1 + (ring - 1) * columns, inner = outer - columns, next = (column + 1) % columns;
      if (ring === 1) faces.push([0, outer + column, outer + next]);
      else faces.push([inner + column, outer + column, outer + next], [inner + column, outer + next, inner + next]);
    }
  }
  return {vertices, faces};
}

function primitive(writer, {vertices, faces}, material) {
  const upper = vertices.flatMap((v, i) => v.position[0] > 0.5 ? [i] : []);
  const swell = vertices.map(v => v.normal.map(n => n * v.height));
  return {
    material,
    indices: writer.array(faces.flat().map(i => [i]), {integers: 'u16', target: 34963}),
    attributes: {
      POSITION: writer.array(vertices.map(v => v.position), {bounds: true}),
      NORMAL: writer.array(vertices.map(v => v.normal)),
      TANGENT: writer.array(vertices.map(v => v.tangent)),
      TEXCOORD_0: writer.array(vertices.map(v => v.texcoord)),
      COLOR_0: writer.array(vertices.map(v => [v.height, 0.5, 0.25, 1])),
      JOINTS_0: writer.array(vertices.map(v => [0, v.height > 0 ? 1 : 0, 0, 0]), {integers: 'u16'}),
      WEIGHTS_0: writer.array(vertices.map(v => [1 - v.height, v.height, 0, 0])),
      _HEIGHT: writer.array(vertices.map(v => [v.height]))
    },
    targets: [
      {
        POSITION: writer.array(swell, {bounds: true}),
        NORMAL: writer.array(vertices.map(() => [0, 0, 0.1])),
        TANGENT: writer.array(vertices.map(() => [0, 0, 0.2]))
      },
      {POSITION: writer.sparse(vertices.length, upper, upper.map(() => [0.5, 0, 0]))},
      {POSITION: writer.array(vertices.map(() => [0, 0, 0]), {bounds: true})}
    ]
  };
}

export function model() {
  const writer = new Writer();
  const primitives = [primitive(writer, wall(24, 10), 0), primitive(writer, lid(24, 4), 1)];
  const identity = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];
  const bind = writer.array([identity, identity], {target: 0, matrix: true});
  const times = writer.array([[0], [1]], {bounds: true, target: 0});
  const turns = writer.array([[0, 0, 0, 1], [0, 0, Math.SQRT1_2, Math.SQRT1_2]], {target: 0});
  const weights = writer.array([0, 0, 0, 1, 0.5, 0].map(w => [w]), {target: 0});
  const image = writer.view(pixel);
  const textured = name => ({name, normalTexture: {index: 0}, pbrMetallicRoughness: {baseColorTexture: {index: 0}}});
  const json = {
    asset: {version: '2.0'},
    scene: 0,
    scenes: [{nodes: [0, 1]}],
    nodes: [{name: 'drum', mesh: 0, skin: 0, weights: [0, 0.5, 0]}, {name: 'foot', children: [2]}, {name: 'head'}],
    skins: [{joints: [1, 2], inverseBindMatrices: bind}],
    meshes: [{name: 'drum', weights: [0, 0, 0], extras: {targetNames: ['swell', 'push', 'rest']}, primitives}],
    materials: [textured('wall'), textured('lid')],
    textures: [{source: 0}],
    images: [{bufferView: image, mimeType: 'image/png'}],
    animations: [{
      samplers: [{input: times, output: turns}, {input: times, output: weights}],
      channels: [{sampler: 0, target: {node: 2, path: 'rotation'}}, {sampler: 1, target: {node: 0, path: 'weights'}}]
    }],
    accessors: writer.accessors,
    bufferViews: writer.views,
    buffers: [{byteLength: writer.bytes}]
  };
  return glb(json, Buffer.concat(writer.chunks));
}

export function glb(json, binary) {
  let text = Buffer.from(JSON.stringify(json));
  text = Buffer.concat([text, Buffer.alloc((4 - text.length % 4) % 4, ' ')]);
  const u32 = (...values) => Buffer.from(new Uint32Array(values).buffer);
  const length = 12 + 8 + text.length + 8 + binary.length;
  return Buffer.concat([
    Buffer.from('glTF'), u32(2, length, text.length), Buffer.from('JSON'), text, u32(binary.length), Buffer.from('BIN\0'), binary
  ]);
}

export function jsonOf(bytes) {
  return bytes.subarray(0, 4).toString() === 'glTF' ? JSON.parse(bytes.subarray(20, 20 + bytes.readUInt32LE(12)))
                                                    : JSON.parse(bytes);
}
