// Measures and the closest point of one triangle. All formulas are homogeneous: coordinates between 1e-70 and 1e70
// apart from each other neither overflow nor vanish.
//
// Closest point: (1) a well-shaped triangle is decided by the signs of dot products of p with two sides (FromSides);
// (2) a sliver, where those signs drown in rounding, is measured in a frame whose first axis is its longest side, so
// that errors move the answer across the sliver and not along it (FromLongestSide). Rejected: (2) always; it costs
// twice as much.
#include "core/geometry/triangle.h"

#include <utility>

namespace meshfront {
namespace {

// Squared sine of the angle at `a` below which a triangle is measured as a sliver.
constexpr double kSliverSineSquared = 1e-6;
// Squared height over squared longest side below which a triangle is as good as a segment.
constexpr double kFlatHeightSquared = 1e-28;

// Twice the area, from the two shorter sides: those lose least where the triangle is a needle.
double DoubleAreaOfNeedle(const Vec3& ab, const Vec3& bc, const Vec3& ca) {
  const double ab2 = SquaredNorm(ab), bc2 = SquaredNorm(bc), ca2 = SquaredNorm(ca);
  if (ab2 >= bc2 && ab2 >= ca2) return Norm(Cross(bc, ca));
  return bc2 >= ca2 ? Norm(Cross(ca, ab)) : Norm(Cross(ab, bc));
}

TrianglePoint AtCorner(int corner, const Vec3& position) {
  TrianglePoint out{{0, 0, 0}, 4 + corner, position};
  out.weights[corner] = 1;
  return out;
}

// On the side from `corner` (at p) to the next (at q), at p + t (q - p).
TrianglePoint OnSide(int corner, double t, const Vec3& p, const Vec3& q) {
  if (!(t > 0)) return AtCorner(corner, p);
  const int next = corner == 2 ? 0 : corner + 1;
  if (!(t < 1)) return AtCorner(next, q);
  TrianglePoint out{{0, 0, 0}, 1 + corner, p + t * (q - p)};
  out.weights[corner] = 1 - t;
  out.weights[next] = t;
  return out;
}

TrianglePoint FromSegments(const Vec3& p, const Vec3* const (&corner)[3]) {
  TrianglePoint best{};
  double best_distance = 0;
  for (int i = 0; i < 3; ++i) {
    const Vec3 &q = *corner[i], &r = *corner[i == 2 ? 0 : i + 1];
    const double length2 = SquaredDistance(q, r);
    const TrianglePoint side = OnSide(i, length2 > 0 ? Dot(p - q, r - q) / length2 : 0, q, r);
    const double distance = SquaredDistance(p, side.position);
    if (i == 0 || distance < best_distance) best = side, best_distance = distance;
  }
  return best;
}

TrianglePoint FromLongestSide(const Vec3& p, const Vec3* const (&corner)[3]) {
  int base = 0;
  double base2 = -1;
  for (int i = 0; i < 3; ++i) {
    const double length2 = SquaredDistance(*corner[i], *corner[(i + 1) % 3]);
    if (length2 > base2) base = i, base2 = length2;
  }
  const Vec3 &a = *corner[base], &b = *corner[(base + 1) % 3], &c = *corner[(base + 2) % 3];
  const Vec3 ab = b - a;
  const double foot = base2 > 0 ? Dot(c - a, ab) / base2 : 0;
  const Vec3 height = (c - a) - foot * ab;
  const double height2 = SquaredNorm(height);
  if (height2 > kFlatHeightSquared * base2) {
    const double w = Dot(p - a, height) / height2;
    const double v = Dot(p - a, ab) / base2 - w * foot;
    const double u = 1 - v - w;
    if (u > 0 && v > 0 && w > 0) {
      TrianglePoint out{{0, 0, 0}, 0, a + v * ab + w * (c - a)};
      out.weights[base] = u, out.weights[(base + 1) % 3] = v, out.weights[(base + 2) % 3] = w;
      return out;
    }
  }
  return FromSegments(p, corner);
}

//            c
//           / \   · p
//          a---b
//
// The plane falls into seven regions: behind a corner when p projects before it on both of its sides; beyond a side when p
// projects into it and the signed area of p with it is negative; inside otherwise.
TrianglePoint FromSides(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a, ac = c - a, ap = p - a, bp = p - b, cp = p - c;
  const double a_ab = Dot(ab, ap), a_ac = Dot(ac, ap);
  if (a_ab <= 0 && a_ac <= 0) return AtCorner(0, a);
  const double b_ab = Dot(ab, bp), b_ac = Dot(ac, bp);
  if (b_ab >= 0 && b_ac <= b_ab) return AtCorner(1, b);
  const double c_ab = Dot(ab, cp), c_ac = Dot(ac, cp);
  if (c_ac >= 0 && c_ab <= c_ac) return AtCorner(2, c);
  const double area_c = a_ab * b_ac - b_ab * a_ac;
  if (area_c <= 0 && a_ab >= 0 && b_ab <= 0) return OnSide(0, a_ab / (a_ab - b_ab), a, b);
  const double area_b = c_ab * a_ac - a_ab * c_ac;
  if (area_b <= 0 && a_ac >= 0 && c_ac <= 0) return OnSide(2, c_ac / (c_ac - a_ac), c, a);
  const double area_a = b_ab * c_ac - c_ab * b_ac;
  const double from_b = b_ac - b_ab, from_c = c_ab - c_ac;
  if (area_a <= 0 && from_b >= 0 && from_c >= 0) return OnSide(1, from_b / (from_b + from_c), b, c);
  const double scale = 1 / (area_a + area_b + area_c);
  const double v = area_b * scale, w = area_c * scale;
  return {{1 - v - w, v, w}, 0, a + v * ab + w * ac};
}

}  // namespace

double RadiusRatio(const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a, bc = c - b, ca = a - c;
  const double ab2 = SquaredNorm(ab), bc2 = SquaredNorm(bc), ca2 = SquaredNorm(ca);
  double double_area2 = SquaredNorm(Cross(ab, ca));
  if (double_area2 < kSliverSineSquared * ab2 * ca2) {
    const double double_area = DoubleAreaOfNeedle(ab, bc, ca);
    double_area2 = double_area * double_area;
  }
  return RadiusRatioOfSquares(ab2, bc2, ca2, double_area2);
}

double RadiusRatioOfSides(double a, double b, double c) {
  if (a < b) std::swap(a, b);
  if (a < c) std::swap(a, c);
  if (b < c) std::swap(b, c);
  // a >= b >= c. The brackets keep the differences exact where they are small (Heron's formula as Kahan orders it).
  const double slack = c - (a - b);
  const double denominator = a * b * c;
  if (!(slack > 0) || !(denominator > 0)) return 0;
  return std::min(1.0, slack * (c + (a - b)) * (a + (b - c)) / denominator);
}

double MinAngle(const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a, bc = c - b, ca = a - c;
  const double ab2 = SquaredNorm(ab), bc2 = SquaredNorm(bc), ca2 = SquaredNorm(ca);
  const double double_area = DoubleAreaOfNeedle(ab, bc, ca);
  if (!(double_area > 0)) return 0;
  // The smallest angle lies opposite the shortest side.
  const double cosine = ab2 <= bc2 && ab2 <= ca2 ? -Dot(bc, ca) : bc2 <= ca2 ? -Dot(ca, ab) : -Dot(ab, bc);
  return std::atan2(double_area, cosine);
}

TrianglePoint ClosestPointOnTriangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a, ac = c - a;
  const double n2 = SquaredNorm(Cross(ab, ac));
  if (n2 > kSliverSineSquared * SquaredNorm(ab) * SquaredNorm(ac)) return FromSides(p, a, b, c);
  return FromLongestSide(p, {&a, &b, &c});
}

}  // namespace meshfront
