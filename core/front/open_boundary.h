// What bounds a mesh: the rims of its surface, and what its fronts have left open.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "absl/types/span.h"
#include "core/front/front_set.h"

namespace meshfront {

// An edge of a rim of the surface, by FrontSet::IdentityOf of its ends in the direction of its initial front.
using RimEdge = std::pair<uint32_t, uint32_t>;

struct OpenBoundary {
  uint64_t edges = 0, loops = 0;
  uint64_t pinched_vertices = 0;  // with more than two of the edges: their triangles are not one fan
};

// Of all fronts, in the order of their first edges.
std::vector<std::vector<FrontEdgeId>> OpenLoops(const FrontSet& fronts);

// Counts the rims where they have a triangle, the triangles' sides on open fronts, and the creases with a triangle on one side
// only. `rims`: those of the surface, creases left out. O(rims + open fronts + creases).
OpenBoundary MeasureBoundary(const FrontSet& fronts, absl::Span<const RimEdge> rims);

}  // namespace meshfront
