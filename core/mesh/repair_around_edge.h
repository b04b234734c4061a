// Which of the faces at one edge continue in which: faces sorted by their angle around the edge.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "absl/types/span.h"
#include "core/mesh/triangle_mesh.h"

namespace meshfront {

// One face at an edge from `a` to `b`.
struct FaceAtEdge {
  uint32_t half_edge = 0;
  bool forward = true;  // runs from a to b
  Vec3 apex;            // its third corner
};

// Pairs faces at an edge with any number of them.
//
//     solid |   | solid
//      ─────┘   └─────
//      ─────┐   ┌─────
//     solid |   | solid
//
// Seen along the edge, faces whose backs look at each other bound a piece of solid between them and are paired,
// innermost first, so that pairs do not cross: two cubes that share an edge come apart as two cubes. With three faces
// the flattest two in opposite directions are paired: a sheet stays whole and the fin on it comes off.
//
// With `opposed_only`, pairs are in opposite directions and no pair is a triangle and its copy; otherwise what is left
// over is paired in angular order. Returns pairs of half-edges.
std::vector<std::pair<uint32_t, uint32_t>> PairFacesAround(const Vec3& a, const Vec3& b, std::vector<FaceAtEdge> faces,
                                                           bool opposed_only);

}  // namespace meshfront
