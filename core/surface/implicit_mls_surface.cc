// EvaluateIn is the one formula; everything else asks it. FindApex: the circle on which both distances are as wanted,
// then Newton's method on its angle from the direction in which the surface goes on (FindAngle). Snap: Newton's method
// along the gradient (Descend), then along the surface until what is left is normal to it. Rejected: Newton's method
// for the three equations at once; it leaves the circle, and finds no more.
#include "core/surface/implicit_mls_surface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/base/processor.h"
#include "core/base/status_macros.h"
#include "core/surface/tolerances.h"

namespace meshfront {
namespace {

using namespace surface_tolerances;

constexpr size_t kGrain = 256;
// Where FindAngle looks for a change of sign when Newton's method finds none, in this order.
constexpr std::array<double, 8> kTriedAngles = {0.35, -0.35, 0.7, -0.7, 1.0, -1.0, 1.3, -1.3};

double MaxCurvatureIn(const MlsValue<2>& value) {
  const auto [low, high] = PrincipalCurvatures(value.f);
  const double most = std::max(std::abs(low), std::abs(high));
  return value.support > 0 ? std::min(most, kMostCurvaturePerSupport / value.support) : most;
}

// Around x as the origin, so that nothing cancels far from it. The centre n(x)·(x − a(x)) and the mean of n_i·(x − p_i)
// share their sums.
template <int kOrder, bool kWide>
[[gnu::always_inline]] inline MlsValue<kOrder> EvaluateIn(const MlsSamples& samples, const Vec3& x, uint32_t patch) {
  using J = Jet<kOrder>;
  using Sum = JetLanes<kOrder>;
  Sum weight_sum, height_sum, support_sum, sharpness_sum, place_sums[3], normal_sums[3];
  const MlsSample* const all = samples.samples().data();
  for (const uint32_t i : samples.ListOf(patch)) {
    const MlsSample& s = all[i];
    const Vec3 p = s.position - x;
    const double inverse_squared = kWide ? 1 / (s.support * s.support) : s.inverse_squared_radius;
    if (SquaredNorm(p) * inverse_squared >= 1) continue;
    const Sum w = Sum::Of(FourthPower(1.0 - inverse_squared * SquaredDistanceToPlace<kOrder>(Vec3{}, p)));
    weight_sum.AddScaled(1, w);
    height_sum.AddScaled(Dot(s.normal, p), w);
    for (int axis = 0; axis < 3; ++axis)
      place_sums[axis].AddScaled(p[axis], w), normal_sums[axis].AddScaled(s.normal[axis], w);
    support_sum.AddScaled(s.support, w);
    if (kWide) continue;
    if (const double sharp = s.Sharpness(); sharp > 0) sharpness_sum.AddScaled(sharp, w);
  }
  const J weights = weight_sum.Get(), heights = height_sum.Get(), supports = support_sum.Get(),
          sharpness = sharpness_sum.Get();
  const std::array<J, 3> places = {place_sums[0].Get(), place_sums[1].Get(), place_sums[2].Get()};
  const std::array<J, 3> normals = {normal_sums[0].Get(), normal_sums[1].Get(), normal_sums[2].Get()};
  MlsValue<kOrder> result;
  const J square = Dot(normals, normals);
  if (!(weights.value() > 0) || !(square.value() > 0)) {
    const MlsSample& s = samples.samples()[samples.MembersOf(patch)[0]];
    const auto variables = JetVariables<kOrder>(x - s.position);
    for (int axis = 0; axis < 3; ++axis) AddScaled(result.f, s.normal[axis], variables[axis]);
    result.asymmetry2.v[0] = 1;
    return result;
  }
  const std::array<J, 3> variables = JetVariables<kOrder>(Vec3{});
  const J mean = Reciprocal(weights);
  std::array<J, 3> from_centroid;
  for (int axis = 0; axis < 3; ++axis) from_centroid[axis] = variables[axis] - places[axis] * mean;
  const J from_centre = Dot(normals, from_centroid) / Sqrt(square),
          from_planes = (Dot(normals, variables) - heights) * mean;
  result.f = 0.5 * (from_centre + from_planes);
  if (sharpness.value() > 0) result.f += (0.5 - kCentreShareAtEdges) * (sharpness * mean) * (from_planes - from_centre);
  const J support = supports * mean;
  result.asymmetry2 = Dot(from_centroid, from_centroid) / (support * support);
  result.support = support.value();
  return result;
}

// Sums of four numbers at once where the processor can; elementwise, so that the bits are the same.
MESHFRONT_WIDE MlsValue<1> FirstOrder(const MlsSamples& samples, const Vec3& x, uint32_t patch) {
  return EvaluateIn<1, false>(samples, x, patch);
}
MESHFRONT_WIDE MlsValue<1> FirstOrderWide(const MlsSamples& samples, const Vec3& x, uint32_t patch) {
  return EvaluateIn<1, true>(samples, x, patch);
}
MESHFRONT_WIDE MlsValue<2> SecondOrder(const MlsSamples& samples, const Vec3& x, uint32_t patch) {
  return EvaluateIn<2, false>(samples, x, patch);
}
MESHFRONT_WIDE MlsValue<2> SecondOrderWide(const MlsSamples& samples, const Vec3& x, uint32_t patch) {
  return EvaluateIn<2, true>(samples, x, patch);
}

}  // namespace

template <int kOrder, bool kWide>
MlsValue<kOrder> ImplicitMlsSurface::Evaluate(const Vec3& x, uint32_t patch) const {
  if constexpr (kOrder == 1)
    return kWide ? FirstOrderWide(*samples_, x, patch) : FirstOrder(*samples_, x, patch);
  else
    return kWide ? SecondOrderWide(*samples_, x, patch) : SecondOrder(*samples_, x, patch);
}
template MlsValue<1> ImplicitMlsSurface::Evaluate<1>(const Vec3&, uint32_t) const;
template MlsValue<1> ImplicitMlsSurface::Evaluate<1, true>(const Vec3&, uint32_t) const;
template MlsValue<2> ImplicitMlsSurface::Evaluate<2>(const Vec3&, uint32_t) const;
template MlsValue<2> ImplicitMlsSurface::Evaluate<2, true>(const Vec3&, uint32_t) const;

ImplicitMlsSurface::ImplicitMlsSurface(std::unique_ptr<MlsSamples> samples) : samples_(std::move(samples)) {}

absl::Status ImplicitMlsSurface::ComputeCurvature(const Context& context) {
  std::vector<double> curvatures(samples_->samples().size());
  std::vector<float> asymmetries(curvatures.size());
  MESHFRONT_RETURN_IF_ERROR(ParallelFor(curvatures.size(), kGrain, context, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const auto at = static_cast<uint32_t>(i);
      if (samples_->ComponentOf(at) == MlsSamples::kStray) continue;
      const MlsValue<2> value = Evaluate<2, true>(samples_->samples()[i].position, samples_->PatchOf(at));
      curvatures[i] = MaxCurvatureIn(value);
      asymmetries[i] = static_cast<float>(std::sqrt(value.asymmetry2.value()));
    }
  }));
  curvatures_ = std::move(curvatures);
  asymmetries_ = std::move(asymmetries);
  return absl::OkStatus();
}

double ImplicitMlsSurface::MaxCurvatureAt(const SourcePoint& p) const {
  return MaxCurvatureIn(Evaluate<2>(p.position, samples_->PatchNear(p.position, p.normal, p.patch)));
}

double ImplicitMlsSurface::AsymmetryAt(uint32_t sample) const {
  if (sample < asymmetries_.size()) return asymmetries_[sample];
  return std::sqrt(
      Evaluate<1, true>(samples_->samples()[sample].position, samples_->PatchOf(sample)).asymmetry2.value());
}

SourcePoint ImplicitMlsSurface::AtSample(uint32_t sample) const {
  const MlsSample& s = samples_->samples()[sample];
  return Descend(s.position, s.normal, samples_->PatchOf(sample));
}

// Newton's method for f along its gradient. Far from all samples it begins at the nearest one.
SourcePoint ImplicitMlsSurface::Descend(Vec3 x, const Vec3& normal, uint32_t patch) const {
  SourcePoint at{x, normal, patch};
  for (int step = 0; step < kMaxMlsSteps; ++step) {
    at.patch = samples_->PatchNear(x, at.normal, at.patch);
    MlsValue<1> value = Evaluate<1>(x, at.patch);
    if (value.support == 0) {
      const uint32_t nearest = samples_->NearestLike(x, normal);
      if (nearest == PointTree::kNone) break;
      x = samples_->samples()[nearest].position, at.patch = samples_->PatchOf(nearest);
      value = Evaluate<1>(x, at.patch);
    }
    const Vec3 gradient = value.f.Gradient();
    const double slope2 = SquaredNorm(gradient);
    if (!(slope2 > 0)) break;
    Vec3 move = (-value.f.value() / slope2) * gradient;
    const double length = Norm(move);
    if (length > value.support) move *= value.support / length;
    x += move;
    at.normal = gradient / std::sqrt(slope2);
    if (length <= kLastMlsStep * value.support) break;
  }
  at.position = x;
  return at;
}

SourcePoint ImplicitMlsSurface::Snap(const SourcePoint& start, const Vec3& target) const {
  SourcePoint at = Descend(target, start.normal, start.patch);
  for (int round = 0; round < kMaxFootRounds; ++round) {
    const Vec3 rest = target - at.position, beside = rest - Dot(rest, at.normal) * at.normal;
    if (SquaredNorm(beside) <= kFootResidual * kFootResidual * SquaredNorm(rest)) break;
    const SourcePoint next = Descend(at.position + beside, at.normal, at.patch);
    if (SquaredDistance(next.position, target) >= SquaredNorm(rest)) break;
    at = next;
  }
  return at;
}

SourcePoint ImplicitMlsSurface::FootOf(const SourcePoint& start, const Vec3& x) const {
  return Descend(x, start.normal, start.patch);
}

// The places at both distances: center + radius (cos angle · open + sin angle · up).
struct ImplicitMlsSurface::Circle {
  Vec3 center, open, up;
  double radius;

  Vec3 At(double angle) const { return center + radius * (std::cos(angle) * open + std::sin(angle) * up); }
  Vec3 DirectionAt(double angle) const { return radius * (std::cos(angle) * up - std::sin(angle) * open); }
};

std::optional<double> ImplicitMlsSurface::FindAngle(const Circle& circle, const Vec3& normal, double angle,
                                                    SourcePoint& at) const {
  for (int step = 0; step < kMaxMlsSteps; ++step) {
    const Vec3 x = circle.At(angle);
    at.patch = samples_->PatchNear(x, normal, at.patch);
    const MlsValue<1> value = Evaluate<1>(x, at.patch);
    if (value.support == 0) return std::nullopt;
    const double slope = Dot(value.f.Gradient(), circle.DirectionAt(angle));
    if (slope == 0) return std::nullopt;
    const double move = std::clamp(-value.f.value() / slope, -kLongestCircleStep, kLongestCircleStep);
    angle += move;
    if (std::cos(angle) < kMinFrontAgreement) return std::nullopt;
    if (std::abs(move) > kLastCircleStep) continue;
    at.position = circle.At(angle);
    at.normal = Normalized(value.f.Gradient());
    if (value.asymmetry2.value() > kOutside * kOutside) return std::nullopt;
    return angle;
  }
  return std::nullopt;
}

std::optional<SourcePoint> ImplicitMlsSurface::FindApex(const SourcePoint& a, const SourcePoint& b, double radius_a,
                                                        double radius_b) const {
  const Vec3 ab = b.position - a.position;
  const double base = Norm(ab);
  if (!(base > 0)) return std::nullopt;
  const Vec3 axis = ab / base, normal = Normalized(a.normal + b.normal);
  const double along = 0.5 * (base + (radius_a - radius_b) * (radius_a + radius_b) / base);
  const double radius2 = radius_a * radius_a - along * along;
  const Vec3 open = Cross(axis, normal);
  if (!(radius2 > kTouching * radius_a * radius_a) || SquaredNorm(open) < kMinEdgeToNormalSine * kMinEdgeToNormalSine)
    return std::nullopt;
  Circle circle{a.position + along * axis, Normalized(open), {}, std::sqrt(radius2)};
  circle.up = Cross(circle.open, axis);
  SourcePoint at{{}, normal, a.patch};
  std::optional<double> angle = FindAngle(circle, normal, 0, at);
  for (size_t i = 0; i < kTriedAngles.size() && !angle; ++i) angle = FindAngle(circle, normal, kTriedAngles[i], at);
  if (!angle) return std::nullopt;
  const Vec3 facing = std::cos(*angle) * circle.up - std::sin(*angle) * circle.open;
  if (Dot(at.normal, facing) <= kMinApexAgreement) return std::nullopt;
  return at;
}

}  // namespace meshfront
