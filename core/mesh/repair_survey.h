// What repair and validation ask of single triangles, and the quick look that tells a clean mesh.
#pragma once

#include <cstdint>

#include "absl/status/status.h"
#include "core/geometry/box.h"
#include "core/mesh/adjacency.h"
#include "core/mesh/triangle_mesh.h"

namespace meshfront {

enum class FaceState { kSound, kRepeatedIndex, kNotFinite, kHuge, kZeroArea };
FaceState StateOf(const TriangleMesh& mesh, const Triangle& t);

// InvalidArgument naming the first triangle with an index that no vertex has.
absl::Status ValidateIndices(const TriangleMesh& mesh);

// One pass over the triangles. The median is that of a sample of a thousand.
struct MeshSurvey {
  uint64_t unsound_faces = 0;
  Box3 box;  // of the faces that are sound, or without area only
  double longest_side = 0;
  double median_side = 0;
};
MeshSurvey Survey(const TriangleMesh& mesh);

// The adjacency, when the mesh is an oriented manifold of different triangles: no edge with more than two faces, no two
// faces in the same direction through an edge, one fan at every vertex, no triangle twice.
std::optional<FaceAdjacency> FindManifoldAdjacency(const TriangleMesh& mesh);

}  // namespace meshfront
