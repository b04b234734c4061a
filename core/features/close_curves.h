// Whether rims and creases pass close to what they are not joined to. Ours, not the paper's (core/README.md, step 9 of the walk).
#pragma once

#include <vector>

#include "absl/status/statusor.h"
#include "core/base/context.h"
#include "core/surface/mesh_surface.h"
#include "core/surface/oriented_loop.h"

namespace meshfront {

// True when an edge of the loops lies on a crease, on whose other side the surface goes on, or has a part of the surface within half
// its length of its middle to which the faces around do not lead: another sheet, another part, the other side of a slit. An edge that
// cuts a corner may pass through such a part. True, too, where it would take too long to tell. Cancelled or DeadlineExceeded. About
// 0.1 µs a triangle of the surface where there are loops without creases, and up to 0.2 s where their surroundings are rough.
absl::StatusOr<bool> DoCurvesLieClose(const MeshSurface& surface, const std::vector<OrientedLoop>& loops,
                                      const Context& context);

}  // namespace meshfront
