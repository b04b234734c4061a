//   1. FindSharpVertices: where two straight sides meet at an angle. A circle could not tell anything there.
//   2. FitCurvature: a circle's equation by least squares (CircleFit) over up to three vertices on each side, none beyond a
//      sharp one.
//   3. Clamp by the mean edge.
// Rejected: interpolating five vertices through the one in the middle. On zig-zag rims it reports the zig-zag.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "core/features/curve.h"
#include "core/features/tolerances.h"

namespace meshfront {
namespace {

double ArcBetween(const Curve& curve, size_t i, size_t steps) {
  double arc = 0;
  for (size_t k = 0; k < steps; ++k) arc += Distance(curve[i + k], curve[i + k + 1]);
  return arc;
}

double CosineOf(const Vec3& a, const Vec3& b) {
  const double lengths = Norm(a) * Norm(b);
  return lengths > 0 ? Dot(a, b) / lengths : 1;
}

bool IsSharp(const Curve& curve, size_t i, size_t reach) {
  const size_t n = curve.size(), before = i + n - reach;
  const Vec3& p = curve[i];
  if (CosineOf(p - curve[i + n - 1], curve[i + 1] - p) > kCornerCosine) return false;
  if (CosineOf(p - curve[before], curve[i + reach] - p) > kCornerCosine) return false;
  return Distance(p, curve[before]) >= kStraightShare * ArcBetween(curve, before, reach) &&
         Distance(p, curve[i + reach]) >= kStraightShare * ArcBetween(curve, i, reach);
}

// Least squares of d = c₀ + c₁ s + c₂ q, where s is d along the curve and q = |d|²/2. On a circle d · N = κ q holds exactly, so the
// part of c₂ across c₁ is κ N however long the arc; a quadratic in arc length would be 30 % off over 130°.
class CircleFit {
 public:
  void Add(double s, const Vec3& d) {
    const double q = 0.5 * SquaredNorm(d);
    const Vec3 regressors{1, s, q};
    for (int k = 0; k < 3; ++k) {
      rows_[k] += regressors[k] * regressors;
      sums_[k] += regressors[k] * d;
    }
  }
  // By Cramer's rule; +infinity when the curve folds back on itself here.
  double Curvature() const {
    const Vec3 c12 = Cross(rows_[1], rows_[2]), c20 = Cross(rows_[2], rows_[0]), c01 = Cross(rows_[0], rows_[1]);
    const double determinant = Dot(rows_[0], c12);
    auto coefficient = [&](int k) { return (c12[k] * sums_[0] + c20[k] * sums_[1] + c01[k] * sums_[2]) / determinant; };
    const Vec3 along = coefficient(1);
    const double curvature = Norm(Cross(Normalized(along), coefficient(2)));
    // Three points a mean edge apart give a determinant of one.
    return determinant > kMinDeterminant && std::isfinite(curvature) ? curvature
                                                                     : std::numeric_limits<double>::infinity();
  }

 private:
  std::array<Vec3, 3> rows_{}, sums_{};
};

// The vertices around vertex i, relative to it and in units of their mean edge: up to the reach or a sharp one on each side.
struct Neighbourhood {
  std::array<Vec3, 2 * kCurvatureReach> offsets;
  size_t count = 0;
  Vec3 along;  // unit vector from its first to its last vertex
  double mean_edge = 0;
};

Neighbourhood NeighbourhoodOf(const Curve& curve, const std::vector<bool>& sharp, size_t i) {
  const size_t n = curve.size(), reach = std::min(kCurvatureReach, (n - 1) / 2);
  Neighbourhood around;
  Vec3 ends[2];
  for (const int side : {0, 1}) {
    Vec3 last = curve[i];
    for (size_t k = 1; k <= reach; ++k) {
      const size_t at = side == 0 ? i + k : i + n - k;
      around.mean_edge += Distance(last, curve[at]);
      last = curve[at];
      ends[side] = around.offsets[around.count++] = last - curve[i];
      if (sharp[at % n]) break;
    }
  }
  around.mean_edge /= static_cast<double>(around.count);
  around.along = Normalized(ends[0] - ends[1]);
  return around;
}

double FitCurvature(const Curve& curve, const std::vector<bool>& sharp, size_t i) {
  const Neighbourhood around = NeighbourhoodOf(curve, sharp, i);
  if (!(around.mean_edge > 0)) return 0;
  CircleFit fit;
  fit.Add(0, {});
  for (size_t k = 0; k < around.count; ++k) {
    const Vec3 d = around.offsets[k] / around.mean_edge;
    fit.Add(Dot(d, around.along), d);
  }
  return std::min(fit.Curvature(), 1 / kMinRadiusInEdges) / around.mean_edge;
}

}  // namespace

std::vector<bool> FindSharpVertices(const Curve& curve) {
  const size_t reach = std::clamp<size_t>(curve.size() / 8, 1, kCurvatureReach);
  std::vector<bool> sharp(curve.size());
  for (size_t i = 0; i < curve.size(); ++i) sharp[i] = IsSharp(curve, i, reach);
  return sharp;
}

std::vector<double> CurveCurvatures(const Curve& curve) {
  const std::vector<bool> sharp = FindSharpVertices(curve);
  std::vector<double> curvatures(curve.size());
  for (size_t i = 0; i < curve.size(); ++i) curvatures[i] = sharp[i] ? 0 : FitCurvature(curve, sharp, i);
  return curvatures;
}

}  // namespace meshfront
