// Dominance pruning: which sizing samples can hold the minimum of the guidance field somewhere.
#pragma once

#include <vector>

#include "absl/status/statusor.h"
#include "core/base/context.h"
#include "core/guidance/sizing.h"

namespace meshfront {

// Drops every sample whose cone lies nowhere below the lower envelope of the others and the clamp: sample i goes when some
// kept k has ĝ_k(|s_i − s_k|) ≤ l_i/η (then ĝ_k ≤ ĝ_i everywhere, by the triangle inequality), or when l_i/η ≥ max_length.
// The kept ones come by increasing ideal length, equal ones in the order given. Lengths must be positive (+infinity is
// dropped) and positions finite. About 0.1–0.3 µs a sample.
absl::StatusOr<std::vector<SizingSample>> PruneDominated(std::vector<SizingSample> samples, double eta,
                                                         double max_length, const Context& context);

}  // namespace meshfront
