// 1. samples whose neighbours lie to one side (FindBeside)    2. from each that no curve has passed yet, outward to the
// rim (GoOutward) 3. along it, step by step, until it closes (Follow): n × ∇ of the asymmetry leads on, Newton's method
// back to both zero sets. Rejected: the front stops where it finds no apex; its rim is as ragged as its triangles are
// long.
#include "core/surface/mls_rims.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "core/base/status_macros.h"
#include "core/geometry/point_tree.h"
#include "core/surface/tolerances.h"

namespace meshfront {
namespace {

using namespace surface_tolerances;

constexpr size_t kGrain = 256;
// Asymmetry of samples that may lie at a rim; at a straight one it is 0.235.
constexpr double kBeside = 0.2;
constexpr double kStep = 0.12;     // along a curve, in parts of the support
constexpr int kOutwardSteps = 12;  // from a sample to the rim
constexpr double kPassed = 1.0;    // a sample so near to a curve, in parts of its support, begins no other
constexpr size_t kMaxSteps = 2000000;
constexpr int kCorrections = 8;
constexpr double kCorrected = 1e-7;  // of the support
constexpr size_t kHalfWindow = 4;    // steps to either side over which the curve's direction is compared
constexpr size_t kLeastPlaces = 8;

struct Frame {
  SourcePoint at;
  Vec3 outward, along;  // in the tangent plane
  double support = 0;
};

// The frame at a place, which may be off both zero sets; nothing where the samples lie evenly around.
std::optional<Frame> FrameAt(const PointSurface& surface, SourcePoint at, Vec3* correction) {
  at.patch = surface.samples().PatchNear(at.position, at.normal, at.patch);
  const MlsValue<1> value = surface.ValueAt(at.position, at.patch);
  const Vec3 gradient = value.f.Gradient();
  const double slope2 = SquaredNorm(gradient);
  if (value.support == 0 || !(slope2 > 0)) return std::nullopt;
  Frame frame{at, {}, {}, value.support};
  frame.at.normal = gradient / std::sqrt(slope2);
  const Vec3 rise = value.asymmetry2.Gradient();
  const Vec3 outward = rise - Dot(rise, frame.at.normal) * frame.at.normal;
  const double steep2 = SquaredNorm(outward);
  if (!(steep2 > 0)) return std::nullopt;
  frame.outward = outward / std::sqrt(steep2);
  frame.along = Cross(frame.outward, frame.at.normal);
  if (correction != nullptr) {
    const Vec3 to_surface = (-value.f.value() / slope2) * gradient;
    const double missing = kOutside * kOutside - value.asymmetry2.value() - Dot(rise, to_surface);
    Vec3 to_rim = (missing / steep2) * outward;
    const double far = Norm(to_rim);
    if (far > 0.5 * kStep * value.support) to_rim *= 0.5 * kStep * value.support / far;
    *correction = to_surface + to_rim;
  }
  return frame;
}

std::optional<Frame> Correct(const PointSurface& surface, SourcePoint at) {
  for (int i = 0; i < kCorrections; ++i) {
    Vec3 correction;
    const std::optional<Frame> frame = FrameAt(surface, at, &correction);
    if (!frame) return std::nullopt;
    at = frame->at;
    at.position += correction;
    if (Norm(correction) > kCorrected * frame->support) continue;
    std::optional<Frame> found = frame;
    found->at.position = at.position;
    found->at.u = 1;  // on the rim
    return found;
  }
  return std::nullopt;
}

// From a sample along the growing asymmetry, over the surface.
std::optional<Frame> GoOutward(const PointSurface& surface, uint32_t sample) {
  SourcePoint at = surface.AtSample(sample);
  for (int step = 0; step < kOutwardSteps; ++step) {
    const std::optional<Frame> frame = FrameAt(surface, at, nullptr);
    if (!frame) return std::nullopt;
    if (surface.ValueAt(at.position, frame->at.patch).asymmetry2.value() >= kOutside * kOutside)
      return Correct(surface, frame->at);
    at = surface.Snap(frame->at, at.position + 0.5 * kStep * frame->support * frame->outward);
  }
  return std::nullopt;
}

// Until it comes back to where it began. False where it is lost.
absl::StatusOr<bool> Follow(const PointSurface& surface, const Frame& start, RimCurve& curve, const Context& context) {
  Frame at = start;
  curve.places.push_back(at.at);
  for (size_t step = 1; step < kMaxSteps; ++step) {
    MESHFRONT_RETURN_IF_ERROR(context.CheckStop());
    const double length = kStep * at.support;
    SourcePoint next = at.at;
    next.position += length * at.along;
    std::optional<Frame> found = Correct(surface, next);
    for (int shorter = 0; shorter < 3 && (!found || Dot(found->along, at.along) < 0); ++shorter) {
      next.position = at.at.position + std::ldexp(length, -1 - shorter) * at.along;
      found = Correct(surface, next);
    }
    if (!found || Distance(found->at.position, at.at.position) > 3 * length) return false;
    if (step >= kLeastPlaces && Distance(found->at.position, start.at.position) < 0.75 * length &&
        Dot(found->along, start.along) > 0)
      return true;
    at = *found;
    curve.places.push_back(at.at);
  }
  return false;
}

void Measure(RimCurve& curve) {
  const size_t n = curve.places.size(), w = std::min(kHalfWindow, n / 4);
  const auto place = [&](size_t i) { return curve.places[i % n].position; };
  curve.curvatures.resize(n);
  for (size_t i = 0; i < n; ++i) {
    curve.length += Distance(place(i), place(i + 1));
    const Vec3 before = place(i) - place(i + n - w), after = place(i + w) - place(i);
    const double way = 0.5 * (Norm(before) + Norm(after));
    curve.curvatures[i] = way > 0 ? Distance(Normalized(before), Normalized(after)) / way : 0;
  }
}

absl::StatusOr<std::vector<bool>> FindBeside(const PointSurface& surface, const Context& context) {
  const size_t n = surface.samples().samples().size();
  std::vector<uint8_t> beside(n, 0);
  MESHFRONT_RETURN_IF_ERROR(ParallelFor(n, kGrain, context, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const auto sample = static_cast<uint32_t>(i);
      if (surface.samples().ComponentOf(sample) == MlsSamples::kStray) continue;
      beside[i] = surface.AsymmetryAt(sample) > kBeside;
    }
  }));
  return std::vector<bool>(beside.begin(), beside.end());
}

}  // namespace

std::optional<SourcePoint> FindRimPlace(const PointSurface& surface, const SourcePoint& near) {
  const std::optional<Frame> found = Correct(surface, near);
  if (!found) return std::nullopt;
  return found->at;
}

absl::StatusOr<RimCurves> TraceRims(const PointSurface& surface, const Context& context) {
  MESHFRONT_ASSIGN_OR_RETURN(const std::vector<bool> beside, FindBeside(surface, context));
  const MlsSamples& samples = surface.samples();
  RimCurves result;
  std::vector<bool> passed(samples.samples().size(), false);
  for (uint32_t i = 0; i < beside.size(); ++i) {
    if (!beside[i] || passed[i]) continue;
    MESHFRONT_RETURN_IF_ERROR(context.CheckStop());
    passed[i] = true;
    const std::optional<Frame> start = GoOutward(surface, i);
    if (!start) continue;
    RimCurve curve;
    MESHFRONT_ASSIGN_OR_RETURN(const bool closes, Follow(surface, *start, curve, context));
    for (const SourcePoint& p : curve.places) {
      for (const uint32_t j : samples.ListOf(p.patch)) {
        const double reach = kPassed * samples.samples()[j].support;
        if (SquaredDistance(p.position, samples.samples()[j].position) <= reach * reach) passed[j] = true;
      }
    }
    if (!closes || curve.places.size() < kLeastPlaces) {
      ++result.lost;
      continue;
    }
    curve.component = samples.ComponentOf(i);
    Measure(curve);
    result.curves.push_back(std::move(curve));
  }
  return result;
}

}  // namespace meshfront
