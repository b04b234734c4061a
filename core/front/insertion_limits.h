// How many vertices a refinement may add.
#pragma once

#include <limits>

namespace meshfront {

struct InsertionLimits {
  double per_triangle = std::numeric_limits<double>::infinity();  // so far, for each triangle made so far
  double in_all = std::numeric_limits<double>::infinity();        // where triangles are far beyond the bound
};

}  // namespace meshfront
