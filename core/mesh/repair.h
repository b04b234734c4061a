// Validation and repair: from whatever came in to an oriented manifold, every change counted.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "core/base/context.h"
#include "core/mesh/adjacency.h"
#include "core/mesh/triangle_mesh.h"

namespace meshfront {

// A kind of change and how often it was made, e.g. {"dropped_degenerate_faces", 30}:
//   dropped_non_finite_faces, dropped_huge_faces   a corner is not finite, or has a coordinate beyond ±1e150
//   moved_spike_vertices          a broken number threw it far off; now in the middle of its neighbours
//   snapped_vertices              of a soup of triangles whose corners almost meet, or of rims that do, now at the same position
//   dropped_degenerate_faces      a repeated index, or no area and nothing to close
//   flipped_degenerate_faces      no area, inside the surface: its long side was turned into the triangle across
//   dropped_duplicate_faces       the same three vertices as an earlier one; both where they only hang on an edge of others
//   welded_vertices               gone into another at the same position, where that joins two rims
//   split_non_manifold_edges      more than two faces met there
//   split_non_manifold_vertices   new copies of vertices, also at split and cut edges
//   reversed_faces                to agree with their neighbours
//   cut_non_orientable_edges      of a component that has one side only
//   dropped_non_manifold_faces    no copy of a vertex could have made them manifold
//   reversed_components           closed and inside out
//   unreferenced_vertices         that no face named; dropped
// and, by RepairInput (remesh.h), at slivers whose sides would be taken for creases (repair_slivers.h):
//   flipped_caps                  a long side was turned into the triangle across
//   collapsed_needles             a short side went, with the two faces beside it
// and, where gaps are to be filled:
//   filled_gaps                   holes, or rims of a point set, that a patch closes
//   gaps_left_open                of that size, but every patch would have passed through something
struct RepairAction {
  std::string what;
  uint64_t count = 0;
};

// One thing that is wrong with a mesh, and where.
struct Defect {
  std::string what;     // "non_manifold_edge", "degenerate_face", "non_finite_vertex", …
  std::string message;  // one sentence with numbers
  std::vector<FaceId> faces;
  std::vector<VertexId> vertices;
  std::optional<Vec3> position;  // unset where it is not finite
};

// Every defect that would stop the engine (at most `limit` are listed; `total` in the result counts all).
struct DefectList {
  std::vector<Defect> defects;
  uint64_t total = 0;
};
DefectList FindDefects(const TriangleMesh& mesh, size_t limit = 100);

struct RepairResult {
  TriangleMesh mesh;  // an oriented manifold, perhaps with boundary, no unreferenced vertices
  std::vector<RepairAction> actions;
  FaceAdjacency adjacency;  // of `mesh`
  uint64_t components = 0;  // likewise; 0: not counted
};
// Makes the best oriented manifold of the mesh. A mesh that is one passes with its bits and its order; repairing a
// repaired mesh changes nothing. InvalidArgument when nothing meshable is there (no finite face with area), an index is
// out of range or the mesh is smaller than 1e-150 across; Cancelled or DeadlineExceeded. 0.15 µs a triangle for clean
// meshes, about 0.6 µs for others.
absl::StatusOr<RepairResult> RepairMesh(TriangleMesh mesh, const Context& context);
// The same, but components that face inwards stay as they are: what is not to be meshed keeps its direction. Where something is repaired
// and `original` is given, the mesh as it came is put there.
absl::StatusOr<RepairResult> RepairMeshAsOriented(TriangleMesh mesh, const Context& context,
                                                  std::optional<TriangleMesh>* original = nullptr);
// For `--repair off`: OK when the mesh can be meshed as it is (unreferenced vertices never matter), else
// FailedPrecondition naming the first defects with their places.
absl::Status RequireManifold(const TriangleMesh& mesh);

}  // namespace meshfront
