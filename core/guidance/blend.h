// The Laplacian system of sec. 4.1: values that are given at some nodes, spread smoothly over the others.
#pragma once

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/types/span.h"
#include "core/base/context.h"

namespace meshfront {

// Two values of a node: the share f of what the border asks for, and f times its edge length. One factorisation serves both.
using BlendValues = std::array<double, 2>;

struct WeightedEdge {
  uint32_t a = 0, b = 0;  // nodes, different
  double weight = 0;      // > 0, finite; of edges given twice it is summed
};

// The values at all of `count` nodes such that each that is not fixed is the mean of its neighbours, by the edges' weights (Δf = 0). Nodes
// that no fixed one is joined to get 0. `fixed`: nodes with their values, each once. Every value lies between those of the fixed ones.
// Internal: the system could not be solved. Stops with the context. About 3 µs a node that is not fixed.
absl::StatusOr<std::vector<BlendValues>> SolveBlend(uint32_t count, absl::Span<const WeightedEdge> edges,
                                                    absl::Span<const std::pair<uint32_t, BlendValues>> fixed,
                                                    const Context& context);

}  // namespace meshfront
