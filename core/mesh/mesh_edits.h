// Changes of a mesh that take its adjacency along.
#pragma once

#include <cstdint>
#include <vector>

#include "core/mesh/adjacency.h"
#include "core/mesh/triangle_mesh.h"

namespace meshfront {

// Makes two half-edges each other's opposite; where one is kNoHalfEdge the other comes to lie on the rim.
inline void LinkHalfEdges(FaceAdjacency& adjacency, uint32_t h, uint32_t g) {
  if (h != kNoHalfEdge) adjacency.opposite[h / 3][h % 3] = g;
  if (g != kNoHalfEdge) adjacency.opposite[g / 3][g % 3] = h;
}

// Before half-edge h is collapsed into its target: the corners of the fan around its origin get the values there, each on its side of a
// seam. `g`: the other half.
void MoveWedges(TriangleMesh& mesh, uint32_t h, uint32_t g, const std::vector<uint32_t>& fan);

// Flips the edge of half-edge h, which has a face on each side, f with h on it and g; with w and d across it:
//
//            w                        w
//     u ─────┴───── v   (f, a cap)  u ┬┴┬ v      Side u → v of f becomes side d → w: f = (u, d, w), g = (d, v, w).
//       \         /           ->    \ │ /
//        \   g   /                   \│/
//            d                        d
//
// w and d must be different vertices that no edge joins, which is not looked at. `outgoing` is not kept: u and v may name a half-edge that
// has left them. O(1).
void FlipEdge(TriangleMesh& mesh, FaceAdjacency& adjacency, uint32_t h);

// Vertices that no triangle names go, with their normals; the others keep their order. O(n + vertices).
void DropUnreferencedVertices(TriangleMesh& mesh, FaceAdjacency& adjacency);

}  // namespace meshfront
