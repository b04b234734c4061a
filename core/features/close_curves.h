// Whether rims and creases pass close to what they are not joined to.
#pragma once

#include <vector>

#include "core/surface/mesh_surface.h"
#include "core/surface/oriented_loop.h"

namespace meshfront {

// True when an edge of the loops lies on a crease, on whose other side the surface goes on, or has a part of the surface within half
// its length that can't be reached from its start over the faces around: another sheet, another part, the other side of a slit. An edge that
// cuts a corner may pass through such a part. About 0.1 µs a triangle of the surface where there are loops without creases.
bool DoCurvesLieClose(const MeshSurface& surface, const std::vector<OrientedLoop>& loops);

}  // namespace meshfront
