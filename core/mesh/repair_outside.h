// Closed components that face inwards.
#pragma once

#include <cstdint>

#include "core/mesh/adjacency.h"
#include "core/mesh/triangle_mesh.h"

namespace meshfront {

struct OutwardTurns {
  uint64_t reversed = 0;    // components
  uint64_t components = 0;  // all that there are
};

// Reverses closed components of an oriented manifold that enclose a negative volume and lie inside no other closed
// component, and with them what lies inside, where its direction is not what its depth asks for. A component that faces
// inwards inside one that faces outwards is a cavity and stays; so does everything that is in doubt (volume near zero,
// too much to look at). Opposites in `adjacency` are of the mesh as it was.
OutwardTurns TurnOutwards(TriangleMesh& mesh, const FaceAdjacency& adjacency);

}  // namespace meshfront
