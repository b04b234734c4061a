// Samples of a point set that no triangle of its mesh lies over.
#pragma once

#include <vector>

#include "core/mesh/triangle_mesh.h"
#include "core/surface/point_surface.h"

namespace meshfront {

// Where a front may begin to cover them: in each connected part of the samples of which it leaves two dozen or more
// uncovered that lie side by side, the place of the one around which the others lie most evenly. 1 µs a sample.
std::vector<SourcePoint> FindUncovered(const PointSurface& surface, const TriangleMesh& mesh);

}  // namespace meshfront
