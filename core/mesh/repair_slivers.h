// Slivers: triangles with area, but so thin that their normals say nothing. Left in, their sides are taken for creases, and the
// surface is cut open along strips that can be filled with needles only. Ours, not the paper's (core/README.md, "Slivers are mended, not
// looked past").
#pragma once

#include <cstdint>
#include <vector>

#include "core/mesh/adjacency.h"
#include "core/mesh/triangle_mesh.h"

namespace meshfront {

struct SliverChanges {
  uint64_t flipped_caps = 0;
  uint64_t collapsed_needles = 0;
  bool any() const { return flipped_caps + collapsed_needles > 0; }
};

// Mends the slivers of an oriented manifold with its adjacency if any has a side in `sharp` (a flag per half-edge): a long side is
// turned into the triangle across, or a short side collapsed. Slivers are lower than kSliverAspect of their longest side and than
// kFlapReaches times `reach` (> 0, a length in the units of the mesh), and have a neighbour that faces elsewhere.
//
//     cap  u ─────┬───── v   hardly above u v     needle  a ═════════> c   a hardly beside b
//                 w                                       b
//
// The new surface stays within `reach` of the old one, all that is done at a place counted together (of collapses: of the planes of the
// triangles around). The other way a flap that was folded over may be lost. Rims, components and genus stay; no triangle gets much
// thinner for it or turns over; walls of thin sheets stay. What can't be mended so stays as well. Faces and vertices keep their
// order, vertices that are not used any more go; `adjacency` is that of the result. O(n), as no face is looked
// at more than 8 times, and vertices with more than 256 neighbours are left alone. 2 to 7 ns a triangle where no sliver is at a sharp edge;
// 50 to 220 on parts with 50 to 700 that are mended. Faces that are `kept` (one flag each; empty: none is) stay as they are, and so do
// their vertices.
SliverChanges MendSlivers(TriangleMesh& mesh, FaceAdjacency& adjacency, const std::vector<bool>& sharp, double reach,
                          const std::vector<bool>& kept = {});

}  // namespace meshfront
