// The numeric margins of this room, each with its unit and reason.
#pragma once

#include <limits>

namespace meshfront {

// Factor on lower bounds that only prune. A bound and the value it bounds are computed by a handful of roundings each; eight
// of them cover both, so that no sample that holds the minimum is ever cut off and the pruned search equals brute force in
// every bit. Likewise on upper bounds that a caller brings along, the other way round.
inline constexpr double kPruneShrink = 1 - 8 * std::numeric_limits<double>::epsilon();
inline constexpr double kPruneGrow = 1 + 8 * std::numeric_limits<double>::epsilon();

}  // namespace meshfront
