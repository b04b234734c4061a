// Exact signs of determinants: on which side of a line or a plane a point lies. A filter in double precision decides
// almost always; where it can't, the determinant is computed exactly as a sum of doubles that do not overlap.
// Exact while no product of three differences of coordinates overflows or falls below 1e-200: differences between 1e-60
// and 1e90, or 0. Pure, thread-safe.
#pragma once

#include "core/geometry/vec3.h"

namespace meshfront {

struct Vec2 {
  double x = 0, y = 0;
  friend constexpr bool operator==(const Vec2&, const Vec2&) = default;
};

// +1 when a, b, c run counter-clockwise, −1 clockwise, 0 on one line. 3 ns when the filter decides.
int Orient2d(const Vec2& a, const Vec2& b, const Vec2& c);

// +1 when d lies above the plane of a, b, c: where they run counter-clockwise as seen from d; −1 below; 0 in the plane.
// 5 ns when the filter decides, 0.2 to 5 µs when not.
int Orient3d(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);

// Whether a, b and c lie on one line, exactly.
bool AreCollinear(const Vec3& a, const Vec3& b, const Vec3& c);

// The point without its coordinate along `axis`; orientation is that seen from the axis' positive end.
constexpr Vec2 DropAxis(const Vec3& p, int axis) {
  return axis == 0 ? Vec2{p.y, p.z} : axis == 1 ? Vec2{p.z, p.x} : Vec2{p.x, p.y};
}

}  // namespace meshfront
