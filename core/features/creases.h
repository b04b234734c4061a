// Which edges of a mesh are creases (sec. 3.3): where the surface turns sharply, along lines that lead somewhere.
#pragma once

#include <vector>

#include "absl/status/statusor.h"
#include "core/base/context.h"
#include "core/mesh/adjacency.h"
#include "core/mesh/triangle_mesh.h"

namespace meshfront {

// One flag per half-edge, set on both halves of a crease. Creases turn by more than `angle` (radians, in (0, π)); gaps of a few
// edges that turn by somewhat less are bridged. Left out are specks of a few faces, as noise makes them, the sides of hairs (lower
// than 5e-4 of the diagonal) between faces that agree, and lines that end inside a smooth patch, unless they start at another
// crease and come a long way straight: those run on to where they fade out, at a quarter of the angle. Nor need straight lines from
// crease to crease turn by more than that, if nothing beside them does. Needs an oriented manifold. Stops with the context. O(n),
// about 0.1 µs a triangle where there are creases.
absl::StatusOr<std::vector<bool>> FindCreases(const TriangleMesh& mesh, const FaceAdjacency& adjacency, double angle,
                                              const Context& context);

}  // namespace meshfront
