// Axis-aligned boxes.
#pragma once

#include <limits>

#include "core/geometry/vec3.h"

namespace meshfront {

struct Box3 {
  Vec3 min{std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity(),
           std::numeric_limits<double>::infinity()};
  Vec3 max = -min;

  bool empty() const { return !(min.x <= max.x); }
  void Extend(const Vec3& p) { min = Min(min, p), max = Max(max, p); }
  void Extend(const Box3& b) { min = Min(min, b.min), max = Max(max, b.max); }
  Vec3 Center() const { return 0.5 * (min + max); }
  double Diagonal() const { return empty() ? 0 : Distance(min, max); }
  // Squared distance from a point to the box; 0 inside.
  double SquaredDistanceTo(const Vec3& p) const { return SquaredNorm(Max(Max(min - p, p - max), Vec3{})); }
};

}  // namespace meshfront
