// The last look at triangles before they leave the window for good (engine sec. 5): does any of them pass through another?
#pragma once

#include <utility>
#include <vector>

#include "absl/functional/function_ref.h"
#include "core/front/front_set.h"

namespace meshfront {

using WindowTrianglePairs = std::vector<std::pair<WindowTriangleId, WindowTriangleId>>;

// Pairs of triangles of the window that meet in more than what they share, the first of each about to leave; vertices of rims and
// creases at equal places are one vertex. Pairs that share a vertex around which the triangles lie side by side are not tested.
// Deterministic. O(window · log window), plus the pairs of overlapping boxes.
WindowTrianglePairs FindIntersections(const FrontSet& fronts, absl::FunctionRef<bool(WindowTriangleId)> leaves);

}  // namespace meshfront
