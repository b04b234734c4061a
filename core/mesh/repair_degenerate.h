// Triangles without area. Inside a manifold they can't just be dropped: that would open holes.
#pragma once

#include <cstdint>

#include "core/mesh/triangle_mesh.h"

namespace meshfront {

// For a mesh of any kind. Drops needles, whose short side's ends become the same point bit for bit, so that the faces
// across the long sides can be joined there; and caps that close nothing: with their long side or two sides on the rim,
// or at an edge with more than two faces (a splinter laid on an edge). Returns how many were dropped.
//
//     needle  ═══════>      cap  a ──────┬────── c    the corner b lies on the long side
//                                        b
uint64_t DropNeedlesAndLooseCaps(TriangleMesh& mesh);

struct FlipChanges {
  uint64_t flipped = 0;  // edges
  uint64_t dropped = 0;  // caps that no flip could mend
};
// For an oriented manifold: turns a cap's long side, so that its corner splits the triangle across; the surface stays
// the same. What can't be turned is dropped (the mesh may have pinched vertices then).
FlipChanges FlipCaps(TriangleMesh& mesh);

}  // namespace meshfront
