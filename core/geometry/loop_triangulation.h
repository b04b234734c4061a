// A minimum-weight triangulation of a loop.
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <vector>

namespace meshfront {

// One triangle of a closure, as positions along the loop: (base, base + span) with the apex between them.
struct ClosureStep {
  int first, last, apex;
};

// Weight of the triangle (first, apex, last) of loop positions, or a negative value when it may not be made.
using ClosureWeight = std::function<double(int first, int apex, int last)>;

// The triangulation of a loop of `count` vertices with the least sum of weights, in an order in which each step's base (first,
// last) is an edge that an earlier step made (the first step's base is the loop's edge from count − 1 to 0). Nothing when every
// triangulation holds a forbidden triangle. O(count³) weights.
std::optional<std::vector<ClosureStep>> TriangulateLoop(int count, const ClosureWeight& weight);

}  // namespace meshfront
