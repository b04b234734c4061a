// glTF 2.0: GLB and .gltf.
#pragma once

#include "core/io/output.h"
#include "core/io/source.h"

namespace meshfront {

bool IsGlb(const Source& source);   // the magic "glTF"
bool IsGltf(const Source& source);  // text that begins with {

// The default scene (the first one, where none is named; all root nodes or meshes, where there is no scene): every triangle
// primitive of every node, transformed; a mesh that several nodes name is there several times; a mirroring transform turns its
// triangles over. Triangles, strips and fans; without any, the points of all primitives are a point set. Positions may be
// quantised and normalised (KHR_mesh_quantization) and sparse. Attributes, morph targets, materials and what stands around the
// meshes: gltf_attributes.h.
// Refused: indices and sizes that don't fit together, nodes in a cycle, a required extension we don't know (Draco, meshopt),
// buffers outside the base folder, and copies that would make the result larger than 16 times the file (and 32 MB).
absl::StatusOr<ReadResult> ReadGlb(const Source& source);
absl::StatusOr<ReadResult> ReadGltf(const Source& source);

// One node, one primitive, 32-bit floats, normals where the mesh has them (all of unit length, else none are written). When the
// centre is more than 100 diagonals from the origin, positions are relative to it and the node is translated. A point set
// becomes a primitive of points. .gltf holds its buffer as a data uri.
// InvalidArgument for coordinates that are not finite or beyond a float, and for more than GLB's 4 GiB.
absl::Status WriteGlb(const TriangleMesh& mesh, Output& output);
absl::Status WriteGltf(const TriangleMesh& mesh, Output& output);

}  // namespace meshfront
