#include "core/mesh/side_fit.h"

#include <cmath>

#include "Eigen/Dense"

namespace meshfront {
namespace {

constexpr size_t kFewestOfQuadric = 12;
// How much more than a plane's share of the residual the three terms of a bend must take away (Fisher's F): where it is noise, it would
// be carried on beyond the samples.
constexpr double kClearBend = 4;
// Of the weight, added to the squares of the second-order terms: a strip as narrow as its spacing does not tell them.
constexpr double kRidge = 1e-5;
constexpr int kMaxNewtonSteps = 12;
constexpr double kLastStep = 1e-9;  // in parts of the radius
// Of the Gram determinant of unit normals: the square of the sine where two fits meet, here 6°.
constexpr double kLeastDeterminant = 0.01;

using Terms = Eigen::Matrix<double, 6, 1>;

Terms TermsAt(double a, double b) {
  Terms t;
  t << 1, a, b, a * a, a * b, b * b;
  return t;
}

}  // namespace

double SideFit::HeightAt(const Vec3& x) const {
  const Vec3 d = (x - origin) / radius;
  const double a = Dot(d, u), b = Dot(d, v);
  return radius * (Dot(d, normal) - (c[0] + c[1] * a + c[2] * b + c[3] * a * a + c[4] * a * b + c[5] * b * b));
}

Vec3 SideFit::GradientAt(const Vec3& x) const {
  const Vec3 d = (x - origin) / radius;
  const double a = Dot(d, u), b = Dot(d, v);
  return normal - (c[1] + 2 * c[3] * a + c[4] * b) * u - (c[2] + c[4] * a + 2 * c[5] * b) * v;
}

SideFit FitSide(const Vec3& x, double radius, absl::Span<const Vec3> positions, absl::Span<const Vec3> normals,
                absl::Span<const uint32_t> samples) {
  SideFit fit;
  fit.origin = x, fit.radius = radius;
  const auto weight_of = [&](const Vec3& d) {
    const double rest = std::max(1 - SquaredNorm(d), 0.01);
    return rest * rest;
  };
  Vec3 normal;
  for (const uint32_t i : samples) normal += weight_of((positions[i] - x) / radius) * normals[i];
  fit.normal = Normalized(normal);
  const Vec3 n = fit.normal;
  const Vec3 other = std::abs(n.x) < 0.6 ? Vec3{1, 0, 0} : std::abs(n.y) < 0.6 ? Vec3{0, 1, 0} : Vec3{0, 0, 1};
  fit.u = Normalized(Cross(n, other));
  fit.v = Cross(n, fit.u);
  Eigen::Matrix<double, 6, 6> matrix = Eigen::Matrix<double, 6, 6>::Zero();
  Terms right = Terms::Zero();
  for (const uint32_t i : samples) {
    const Vec3 d = (positions[i] - x) / radius;
    const double w = weight_of(d);
    const Terms t = TermsAt(Dot(d, fit.u), Dot(d, fit.v));
    matrix += w * t * t.transpose();
    right += w * Dot(d, n) * t;
    fit.weight += w;
  }
  const auto solve = [&](int terms) {
    SideFit solved = fit;
    Eigen::Matrix<double, 6, 6> used = matrix;
    Terms wanted = right;
    for (int k = 3; k < 6; ++k) {
      if (terms == 3) used.row(k).setZero(), used.col(k).setZero(), wanted[k] = 0, used(k, k) = 1;
      used(k, k) += kRidge * fit.weight;
    }
    const Terms c = used.ldlt().solve(wanted);
    for (int k = 0; k < 6; ++k) solved.c[k] = std::isfinite(c[k]) ? c[k] : 0;
    for (const uint32_t i : samples) {
      const double height = solved.HeightAt(positions[i]);
      solved.residual2 += weight_of((positions[i] - x) / radius) * height * height;
    }
    return solved;
  };
  const SideFit plane = solve(3);
  if (samples.size() < kFewestOfQuadric) return plane;
  const SideFit quadric = solve(6);
  const double degrees = static_cast<double>(samples.size()) - 6;
  return plane.residual2 > quadric.residual2 * (1 + 3 * kClearBend / degrees) ? quadric : plane;
}

// Newton's method with the shortest step to where all linear parts are zero.
std::optional<Vec3> FindMeeting(absl::Span<const SideFit* const> fits, const Vec3& x, double reach) {
  const auto n = static_cast<int>(fits.size());
  Vec3 at = x;
  for (int step = 0; step < kMaxNewtonSteps; ++step) {
    std::array<Vec3, 3> normals;
    Eigen::Matrix3d gram = Eigen::Matrix3d::Identity();
    Eigen::Vector3d values = Eigen::Vector3d::Zero();
    for (int i = 0; i < n; ++i) {
      const Vec3 gradient = fits[i]->GradientAt(at);
      const double slope = Norm(gradient);
      normals[i] = gradient / slope;
      values[i] = fits[i]->HeightAt(at) / slope;
    }
    for (int i = 0; i < n; ++i) {
      for (int j = 0; j < n; ++j) gram(i, j) = Dot(normals[i], normals[j]);
    }
    if (gram.determinant() < kLeastDeterminant) return std::nullopt;
    const Eigen::Vector3d by = gram.ldlt().solve(-values);
    Vec3 move;
    for (int i = 0; i < n; ++i) move += by[i] * normals[i];
    at += move;
    if (!(SquaredDistance(at, x) <= reach * reach)) return std::nullopt;
    if (Norm(move) <= kLastStep * fits[0]->radius) break;
  }
  return at;
}

}  // namespace meshfront
