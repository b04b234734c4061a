// Measures and closest points of one triangle.
#pragma once

#include <algorithm>

#include "core/geometry/vec3.h"

namespace meshfront {

// Twice the area times the unit normal, right-handed around a, b, c.
constexpr Vec3 AreaVector(const Vec3& a, const Vec3& b, const Vec3& c) { return Cross(b - a, c - a); }
inline double TriangleArea(const Vec3& a, const Vec3& b, const Vec3& c) { return 0.5 * Norm(AreaVector(a, b, c)); }
constexpr double SquaredLongestSide(const Vec3& a, const Vec3& b, const Vec3& c) {
  return std::max({SquaredDistance(a, b), SquaredDistance(b, c), SquaredDistance(c, a)});
}
// Radius ratio q = 2r/R = 16 A² / (abc (a + b + c)): 1 equilateral, 0 degenerate.
double RadiusRatio(const Vec3& a, const Vec3& b, const Vec3& c);
// The same from the sides and the square of twice the area.
inline double RadiusRatioOfLengths(double ab, double bc, double ca, double double_area2) {
  const double denominator = ab * bc * ca * (ab + bc + ca);
  return denominator > 0 ? std::min(1.0, 4 * double_area2 / denominator) : 0;
}
// … and from their squares.
inline double RadiusRatioOfSquares(double ab2, double bc2, double ca2, double double_area2) {
  return RadiusRatioOfLengths(std::sqrt(ab2), std::sqrt(bc2), std::sqrt(ca2), double_area2);
}
// The same from the three side lengths; 0 when they violate the triangle inequality.
double RadiusRatioOfSides(double a, double b, double c);
// Smallest of the three angles, in radians; 0 for a degenerate triangle.
double MinAngle(const Vec3& a, const Vec3& b, const Vec3& c);

// The point of a triangle closest to p, as barycentric weights of a, b, c. `region` says where it lies: 0 inside,
// 1..3 in the interior of edge ab, bc, ca, 4..6 at a, b, c. Degenerate triangles give the closest point of their edges.
struct TrianglePoint {
  double weights[3];
  int region;
  Vec3 position;
};
TrianglePoint ClosestPointOnTriangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c);

}  // namespace meshfront
