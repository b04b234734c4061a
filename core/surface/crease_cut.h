// Cutting a mesh open along its creases: each smooth patch becomes a sheet of its own, with a rim where the crease is, so that
// normals, curvatures, walks and fits are one-sided without knowing it (sec. 3.3).
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/mesh/adjacency.h"
#include "core/mesh/triangle_mesh.h"

namespace meshfront {

struct CreaseCut {
  TriangleMesh mesh;                              // the same faces; vertices on creases once for each side
  FaceAdjacency adjacency;                        // of the cut mesh: creases are rims
  std::vector<uint32_t> original;                 // of each vertex: the one that it is a copy of
  std::vector<std::array<uint32_t, 3>> opposite;  // across each side before the cut, as in FaceAdjacency
};

// `creases`: one flag per half-edge, set on both halves of an edge or on neither. Copies of a vertex are numbered behind the
// others, in the order of their half-edges; nothing moves. O(n).
CreaseCut CutAlongCreases(TriangleMesh mesh, FaceAdjacency adjacency, const std::vector<bool>& creases);

}  // namespace meshfront
