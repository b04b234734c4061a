// Everything is written in s = sin(angle / 2) = length κ / 2 rather than in the angle: eq. 6 is then free of cancellation,
//
//   ξ = (1 − √((1 + 2 cos ρ) / 3)) / (2 sin(ρ/2)) = (1 − √(1 − 4s²/3)) / (2s) = (2s/3) / (1 + √(1 − 4s²/3)),
//
// and no formula needs an angle to be computed first. (The difference as printed loses all digits below ρ ≈ 1e-8.)
#include "core/guidance/sizing.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace meshfront {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kMaxAngle = 2 * std::numbers::pi / 3;   // an equilateral triangle on a great circle
constexpr double kMaxHalfSine = 0.86602540378443864676;  // sin(kMaxAngle / 2) = √3/2

// sin(angle / 2) that an edge subtends, clamped to the range of the formulas.
double HalfSine(double length, double max_curvature) {
  if (!(max_curvature > 0) || !(length > 0)) return 0;
  return std::min(0.5 * length * max_curvature, kMaxHalfSine);
}

// ξ as a function of s.
double ErrorPerLengthOfHalfSine(double s) {
  const double under_root = std::max(0.0, 1 - 4 * s * s / 3);
  return (2 * s / 3) / (1 + std::sqrt(under_root));
}

}  // namespace

double IdealLength(double rho, double max_curvature) {
  if (!(max_curvature > 0)) return kInfinity;
  return 2 * std::sin(0.5 * std::clamp(rho, 0.0, kMaxAngle)) / max_curvature;
}

double SubtendedAngle(double length, double max_curvature) {
  return std::min(2 * std::asin(HalfSine(length, max_curvature)), kMaxAngle);
}

double ErrorPerLength(double rho) {
  if (rho >= kMaxAngle) return ErrorPerLengthOfHalfSine(kMaxHalfSine);
  return ErrorPerLengthOfHalfSine(std::sin(0.5 * std::max(rho, 0.0)));
}

double ErrorBound(double length, double max_curvature) {
  const double s = HalfSine(length, max_curvature);
  return s > 0 ? length * ErrorPerLengthOfHalfSine(s) : 0;
}

double LengthForError(double error, double max_curvature) {
  if (!(max_curvature > 0)) return kInfinity;
  if (!(error > 0)) return 0;
  const double product = error * max_curvature;
  if (product >= 1) return std::sqrt(3.0) / max_curvature;
  return std::sqrt(3 * (error / max_curvature) * (2 - product));
}

}  // namespace meshfront
