// Distance to a segment.
#pragma once

#include <algorithm>
#include <cmath>

#include "core/geometry/vec3.h"

namespace meshfront {

// Of p from the segment ab, squared; a and b may be the same.
inline double SquaredDistanceToSegment(const Vec3& p, const Vec3& a, const Vec3& b) {
  const Vec3 d = b - a;
  const double n = SquaredNorm(d);
  const double t = n > 0 ? std::clamp(Dot(p - a, d) / n, 0.0, 1.0) : 0.0;
  return SquaredDistance(p, a + t * d);
}
inline double DistanceToSegment(const Vec3& p, const Vec3& a, const Vec3& b) {
  return std::sqrt(SquaredDistanceToSegment(p, a, b));
}

}  // namespace meshfront
