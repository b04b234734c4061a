// Holes of a mesh are closed by patches that go on as the surface around them does.
#pragma once

#include <cstdint>
#include <vector>

#include "absl/status/statusor.h"
#include "core/base/context.h"
#include "core/geometry/vec3.h"
#include "core/mesh/adjacency.h"
#include "core/mesh/triangle_mesh.h"

namespace meshfront {

struct FilledHoles {
  uint64_t filled = 0;
  std::vector<Vec3> left_open;  // a place on the rim of each hole of that size that no patch closes
};

// Closes the boundary loops of an oriented manifold whose diameter (the largest distance between two of their points) is at most `size`.
// A loop that passes a place several times, by copies of a vertex, is several holes, which touch there; the copies beside those that are
// filled become one vertex. Triangles are added behind those that are there; attributes go on from the rim. A loop stays open where its patches, a fair
// and a taut one, intersect the mesh, themselves or an earlier patch: so does the outer rim of a flat sheet. Cancelled or DeadlineExceeded.
// About 30 µs a triangle of the patches.
absl::StatusOr<FilledHoles> FillHoles(double size, TriangleMesh& mesh, FaceAdjacency& adjacency,
                                      const Context& context);

}  // namespace meshfront
