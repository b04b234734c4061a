// Lines for tests of features.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "core/mesh/polylines.h"

namespace meshfront::testing {

// One line through all points.
inline Polylines Line(std::vector<Vec3> points) {
  Polylines lines;
  for (uint32_t i = 1; i < points.size(); ++i) lines.segments.push_back({i - 1, i});
  lines.points = std::move(points);
  return lines;
}

}  // namespace meshfront::testing
