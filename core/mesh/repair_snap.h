// Soups of triangles whose corners almost meet, as some exporters round each triangle by itself.
#pragma once

#include <cstdint>

#include "core/mesh/triangle_mesh.h"

namespace meshfront {

// When at least half of all sides have no partner at the same position: moves corners that are closer than a thousandth
// of the median side, and a quarter of the shortest, to one common position, so that they can be welded. Returns how
// many vertices moved.
uint64_t SnapSoup(TriangleMesh& mesh);

}  // namespace meshfront
