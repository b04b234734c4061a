// Evaluate: the fit, from the implicit surface's plane, with exact derivatives. Project: Newton's method along the gradient;
// FindApex: on the circle, from the implicit surface's apex. Rejected: steps along the polynomial's gradient, which saves
// the derivatives but is a few percent off, so that feet are found a round later. Rejected: to begin at the implicit
// surface's foot, which lies as much to one side. Rejected: the polynomial's curvature for the surface's; sized by it, as
// many triangles are 10 % farther from a bunny (RMS).
#include "core/surface/mls_surface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/base/status_macros.h"
#include "core/surface/tolerances.h"

namespace meshfront {
namespace {

using namespace surface_tolerances;

constexpr size_t kGrain = 64;

template <int kOrder>
std::optional<MlsFit> FitFrom(const MlsSamples& samples, const MlsValue<kOrder>& start, const Vec3& x, uint32_t patch,
                              std::vector<MlsNear>& near) {
  const double slope = Norm(start.f.Gradient());
  if (!(slope > 0) || start.support == 0) return std::nullopt;
  FindNearSamples(samples, x, patch, near);
  return FitPolynomial(near, start.support, start.f.Gradient() / slope, -start.f.value() / slope);
}

std::vector<MlsNear>& NearScratch() {
  thread_local std::vector<MlsNear> near;
  return near;
}

}  // namespace

MlsSurface::MlsSurface(std::unique_ptr<MlsSamples> samples) : implicit_(std::move(samples)) {}

template <int kOrder>
MlsValue<kOrder> MlsSurface::Evaluate(const Vec3& x, uint32_t patch) const {
  MlsValue<kOrder> value = implicit_.Evaluate<kOrder>(x, patch);
  std::vector<MlsNear>& near = NearScratch();
  if (const std::optional<MlsFit> fit = FitFrom(samples(), value, x, patch, near))
    value.f = DeriveSignedDistance<kOrder>(near, *fit);
  return value;
}
template MlsValue<1> MlsSurface::Evaluate<1>(const Vec3&, uint32_t) const;
template MlsValue<2> MlsSurface::Evaluate<2>(const Vec3&, uint32_t) const;

absl::Status MlsSurface::ComputeCurvature(const Context& context) {
  std::vector<double> curvatures(samples().samples().size());
  MESHFRONT_RETURN_IF_ERROR(ParallelFor(curvatures.size(), kGrain, context, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const auto at = static_cast<uint32_t>(i);
      if (samples().ComponentOf(at) == MlsSamples::kStray) continue;
      curvatures[i] = CurvatureAt(samples().samples()[i].position, samples().PatchOf(at));
    }
  }));
  curvatures_ = std::move(curvatures);
  return absl::OkStatus();
}

double MlsSurface::CurvatureAt(const Vec3& x, uint32_t patch) const {
  const MlsValue<2> value = Evaluate<2>(x, patch);
  const auto [low, high] = PrincipalCurvatures(value.f);
  const double most = std::max(std::abs(low), std::abs(high));
  return value.support > 0 ? std::min(most, kMostCurvaturePerSupport / value.support) : most;
}

double MlsSurface::MaxCurvatureAt(const SourcePoint& p) const {
  return CurvatureAt(p.position, samples().PatchNear(p.position, p.normal, p.patch));
}

SourcePoint MlsSurface::AtSample(uint32_t sample) const {
  const MlsSample& s = samples().samples()[sample];
  return Project({s.position, s.normal, samples().PatchOf(sample)}, s.position);
}

// Far from all samples it begins where the implicit surface is.
SourcePoint MlsSurface::Project(const SourcePoint& start, const Vec3& target) const {
  SourcePoint at{target, start.normal, start.patch};
  for (int step = 0; step < kMaxMlsSteps; ++step) {
    at.patch = samples().PatchNear(at.position, at.normal, at.patch);
    const MlsValue<1> value = Evaluate<1>(at.position, at.patch);
    if (value.support == 0) {
      if (step > 0) break;
      at = implicit_.Snap(start, target);
      continue;
    }
    const Vec3 gradient = value.f.Gradient();
    const double slope2 = SquaredNorm(gradient);
    if (!(slope2 > 0)) break;
    Vec3 move = (-value.f.value() / slope2) * gradient;
    const double length = Norm(move);
    if (length > value.support) move *= value.support / length;
    at.position += move;
    at.normal = gradient / std::sqrt(slope2);
    if (length <= kLastFitStep * value.support) break;
  }
  return at;
}

SourcePoint MlsSurface::Snap(const SourcePoint& start, const Vec3& target) const {
  SourcePoint at = Project(start, target);
  for (int round = 0; round < kMaxFootRounds; ++round) {
    const Vec3 rest = target - at.position, beside = rest - Dot(rest, at.normal) * at.normal;
    if (SquaredNorm(beside) <= kFootResidual * kFootResidual * SquaredNorm(rest)) break;
    const SourcePoint next = Project(at, at.position + beside);
    if (SquaredDistance(next.position, target) >= SquaredNorm(rest)) break;
    at = next;
  }
  return at;
}

// The places at both distances, from the one found on the implicit surface.
struct MlsSurface::Circle {
  Vec3 center, out, across;  // out and across of the circle's radius
  Vec3 At(double angle) const { return center + std::cos(angle) * out + std::sin(angle) * across; }
  Vec3 DirectionAt(double angle) const { return std::cos(angle) * across - std::sin(angle) * out; }
};

// Newton's method on the circle from angle 0. False where it does not end, or where the samples lie to one side.
bool MlsSurface::MoveTo(const Circle& circle, SourcePoint& apex) const {
  double angle = 0;
  for (int step = 0; step < kMaxMlsSteps; ++step) {
    const Vec3 x = circle.At(angle);
    apex.patch = samples().PatchNear(x, apex.normal, apex.patch);
    const MlsValue<1> value = Evaluate<1>(x, apex.patch);
    const double slope = Dot(value.f.Gradient(), circle.DirectionAt(angle));
    if (value.support == 0 || slope == 0) return false;
    const double move = std::clamp(-value.f.value() / slope, -kLongestCircleStep, kLongestCircleStep);
    angle += move;
    if (std::abs(move) > kLastFitAngle) continue;
    apex.position = circle.At(angle);
    apex.normal = Normalized(value.f.Gradient());
    return value.asymmetry2.value() <= kOutside * kOutside;
  }
  return false;
}

std::optional<SourcePoint> MlsSurface::FindApex(const SourcePoint& a, const SourcePoint& b, double radius_a,
                                                double radius_b) const {
  std::optional<SourcePoint> apex = implicit_.FindApex(a, b, radius_a, radius_b);
  if (!apex) return std::nullopt;
  const Vec3 axis = Normalized(b.position - a.position);
  Circle circle{a.position + Dot(apex->position - a.position, axis) * axis, {}, {}};
  circle.out = apex->position - circle.center;
  circle.across = Cross(axis, circle.out);
  if (!MoveTo(circle, *apex)) return std::nullopt;
  const Vec3 open = Cross(axis, Normalized(a.normal + b.normal)), away = apex->position - circle.center;
  if (Dot(away, open) <= kMinFrontAgreement * Norm(circle.out) * Norm(open)) return std::nullopt;
  if (Dot(apex->normal, Cross(away, axis)) <= kMinApexAgreement) return std::nullopt;
  return apex;
}

SourcePoint MlsSurface::FootOf(const SourcePoint& start, const Vec3& x) const { return Project(start, x); }

}  // namespace meshfront
