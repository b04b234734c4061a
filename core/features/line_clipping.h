// Polylines where they lie on some faces of a mesh.
#pragma once

#include <cstdint>
#include <vector>

#include "core/mesh/polylines.h"
#include "core/mesh/triangle_mesh.h"

namespace meshfront {

struct ClippedLines {
  Polylines lines;
  std::vector<uint32_t> origins;  // of each segment, that of the given lines of which it is a part
  std::vector<uint32_t> cut;      // given segments that are not there from end to end, in increasing order
};

// The parts of the segments that lie within 1 % of `diagonal` of the mesh, and there on chosen faces none of whose corners is a corner of
// another one: so that splitting faces along them leaves all others and their sides as they are. A part of a segment between two places that
// are half the mean edge of those faces apart may be missed. `chosen`: one flag a face.
ClippedLines ClipPolylines(const Polylines& lines, const TriangleMesh& mesh, const std::vector<bool>& chosen,
                           double diagonal);

}  // namespace meshfront
