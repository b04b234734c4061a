// Corners that almost meet: of soups, as some exporters round each triangle by itself; and of rims, as where a surface that was made in
// rows closes, at an angle of 2π that is not quite one of 0.
#pragma once

#include <cstdint>
#include <vector>

#include "core/mesh/triangle_mesh.h"

namespace meshfront {

// When at least half of all sides have no partner at the same position: moves corners that are closer than a thousandth
// of the median side, and a quarter of the shortest, to one common position, so that they can be welded. Returns how
// many vertices moved.
uint64_t SnapSoup(TriangleMesh& mesh);

// Moves vertices of rims that are closer than 1e-7 of the diagonal, and a thousandth of the shortest side at either, to one common
// position, so that the rims can be welded. Returns how many vertices moved.
uint64_t SnapRims(TriangleMesh& mesh);
// Whether SnapRims would move some of these vertices.
bool DoRimsAlmostMeet(const TriangleMesh& mesh, const std::vector<uint32_t>& rim_vertices);

}  // namespace meshfront
