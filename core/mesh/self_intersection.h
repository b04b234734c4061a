// Where a mesh meets itself.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "absl/status/statusor.h"
#include "core/base/context.h"
#include "core/mesh/triangle_mesh.h"

namespace meshfront {

struct SelfIntersections {
  uint64_t pairs = 0;
  std::vector<std::pair<FaceId, FaceId>> first_pairs;  // smaller face first, in order, as many as were asked for
  uint64_t skipped_faces = 0;                          // without area (exactly), or with a corner that is not finite
};

// Pairs of triangles that have more in common than a corner or a side, exactly on the coordinates as they are; vertices
// at equal positions count as one. Touching counts, and so do duplicates. O(n log n) for meshes that are surfaces; the
// number of pairs at worst. InvalidArgument when an index is out of range; Cancelled or DeadlineExceeded. The same
// result at any number of threads.
absl::StatusOr<SelfIntersections> FindSelfIntersections(const TriangleMesh& mesh, size_t listed_pairs,
                                                        const Context& context);

}  // namespace meshfront
