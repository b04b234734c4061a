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
// Asymmetry of samples that may lie at a rim; at a straight one it is 0.235, at a hole that is two supports wide half as much. Of samples at
// random on a closed surface one in a hundred has as much; on the way outward from these it does not grow by that much a step.
constexpr double kBeside = 0.1, kLeastGrowth = 0.015;
constexpr double kStep = 0.12;     // along a curve, in parts of the support
constexpr int kOutwardSteps = 12;  // from a sample to the rim
constexpr double kPassed = 1.0;    // a sample so near to a curve, in parts of its support, begins no other
// Of all curves that are lost, for each sample that may lie at a rim: along a straight one there are about four to each.
constexpr size_t kMaxStepsPerSample = 8, kLeastSteps = 20000;
// Of the places of a curve, how many are compared with the curves before, and how near is the same, in steps.
constexpr size_t kCompared = 8;
constexpr double kSameCurve = 0.75;
// Steps between places that are noted of a curve that is lost.
constexpr size_t kLostStride = 16;
// Of a rim in supports as they were before they were widened, and samples of a part that may have a shorter one: a disc of so many has one of seven.
constexpr double kShortestRim = 4;
constexpr size_t kLargestWithShortRim = 64;
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
  double before = 0;
  for (int step = 0; step < kOutwardSteps; ++step) {
    const std::optional<Frame> frame = FrameAt(surface, at, nullptr);
    if (!frame) return std::nullopt;
    const double asymmetry = std::sqrt(surface.ValueAt(at.position, frame->at.patch).asymmetry2.value());
    if (asymmetry >= kOutside) return Correct(surface, frame->at);
    if (asymmetry < before + kLeastGrowth) return std::nullopt;
    before = asymmetry;
    at = surface.Snap(frame->at, at.position + 0.5 * kStep * frame->support * frame->outward);
  }
  return std::nullopt;
}

// Until it comes back to where it began; or, where Newton's method led from a side way into the curve, to the place at the
// last power of two of steps. False where it is lost.
absl::StatusOr<bool> Follow(const PointSurface& surface, const Frame& start, size_t most_steps, RimCurve& curve,
                            const Context& context) {
  Frame at = start, mark = start;
  size_t marked = 0;
  curve.places.push_back(at.at);
  for (size_t step = 1; step < most_steps; ++step) {
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
    const auto is_back = [&](const Frame& frame, size_t since) {
      return step - since >= kLeastPlaces && Distance(found->at.position, frame.at.position) < 0.75 * length &&
             Dot(found->along, frame.along) > 0;
    };
    if (is_back(start, 0)) return true;
    if (is_back(mark, marked)) {
      curve.places.erase(curve.places.begin(), curve.places.begin() + static_cast<std::ptrdiff_t>(marked));
      return true;
    }
    at = *found;
    curve.places.push_back(at.at);
    if (step >= kLeastPlaces && (step & (step - 1)) == 0) mark = at, marked = step;
  }
  return false;
}

// Between samples at random there are places around which few lie to one side, as there is noise: no rim of a part that is
// larger.
bool IsGap(const MlsSamples& samples, const RimCurve& curve, size_t part) {
  double supports = 0;
  for (const SourcePoint& p : curve.places)
    supports += samples.radius() * samples.SpacingAt(samples.MembersOf(p.patch)[0]);
  return part > kLargestWithShortRim &&
         curve.length < kShortestRim * supports / static_cast<double>(curve.places.size());
}

// Whether a curve runs along those before it.
bool IsKnown(const PointSurface& surface, const RimCurve& curve, const std::vector<RimCurve>& known) {
  size_t near = 0;
  for (size_t k = 0; k < kCompared; ++k) {
    const SourcePoint& p = curve.places[k * curve.places.size() / kCompared];
    const MlsSamples& samples = surface.samples();
    const double reach = kSameCurve * kStep * samples.samples()[samples.MembersOf(p.patch)[0]].support;
    near += std::any_of(known.begin(), known.end(), [&](const RimCurve& other) {
      return std::any_of(other.places.begin(), other.places.end(), [&](const SourcePoint& q) {
        return SquaredDistance(p.position, q.position) < reach * reach && Dot(p.normal, q.normal) > 0;
      });
    });
  }
  return 2 * near > kCompared;
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
  const auto count = static_cast<size_t>(std::count(beside.begin(), beside.end(), true));
  std::vector<size_t> sizes(samples.component_count(), 0);
  for (uint32_t i = 0; i < beside.size(); ++i)
    if (samples.ComponentOf(i) != MlsSamples::kStray) ++sizes[samples.ComponentOf(i)];
  size_t steps_left = kLeastSteps + kMaxStepsPerSample * count;
  for (uint32_t i = 0; i < beside.size(); ++i) {
    if (!beside[i] || passed[i]) continue;
    MESHFRONT_RETURN_IF_ERROR(context.CheckStop());
    passed[i] = true;
    const std::optional<Frame> start = GoOutward(surface, i);
    if (!start) continue;
    RimCurve curve;
    MESHFRONT_ASSIGN_OR_RETURN(const bool closes, Follow(surface, *start, steps_left, curve, context));
    for (const SourcePoint& p : curve.places) {
      for (const uint32_t j : samples.ListOf(p.patch)) {
        const double reach = kPassed * samples.samples()[j].support;
        if (SquaredDistance(p.position, samples.samples()[j].position) <= reach * reach) passed[j] = true;
      }
    }
    if (!closes || curve.places.size() < kLeastPlaces) {
      ++result.lost;
      steps_left -= std::min(steps_left, curve.places.size());
      for (size_t k = 0; k < curve.places.size(); k += kLostStride)
        result.lost_places.push_back(curve.places[k].position);
      result.lost_places.push_back(curve.places.back().position);
      continue;
    }
    if (IsKnown(surface, curve, result.curves)) continue;
    curve.component = samples.ComponentOf(i);
    Measure(curve);
    if (IsGap(samples, curve, sizes[curve.component])) continue;
    result.curves.push_back(std::move(curve));
  }
  return result;
}

}  // namespace meshfront
