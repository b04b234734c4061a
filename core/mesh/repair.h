// Validation and repair: from whatever came in to an oriented manifold, every change counted.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "core/base/context.h"
#include "core/mesh/triangle_mesh.h"

namespace meshfront {

// A kind of change and how often it was made, e.g. {"dropped_degenerate_faces", 30}.
struct RepairAction {
  std::string what;
  uint64_t count = 0;
};

// One thing that is wrong with a mesh, and where.
struct Defect {
  std::string what;        // "non_manifold_edge", "degenerate_face", "non_finite_vertex", …
  std::string message;     // one sentence with numbers
  std::vector<FaceId> faces;
  std::vector<VertexId> vertices;
  Vec3 position;
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
};
// Makes the best oriented manifold of the mesh. InvalidArgument when nothing meshable is left (no finite face with area).
absl::StatusOr<RepairResult> RepairMesh(TriangleMesh mesh, const Context& context);
// For `--repair off`: OK when the mesh can be meshed as it is (unreferenced vertices never matter), else FailedPrecondition
// naming the first defects with their places.
absl::Status RequireManifold(const TriangleMesh& mesh);

}  // namespace meshfront
