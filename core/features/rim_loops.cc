// Equal parts of ∫ ds / g around each curve.
#include "core/features/rim_loops.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace meshfront {
namespace {

constexpr size_t kFewestPoints = 3;

OrientedLoop Resample(const PointSurface& surface, const RimCurve& curve, const GuidanceField& field) {
  const size_t n = curve.places.size();
  std::vector<double> summed = {0};
  for (size_t i = 0; i < n; ++i) {
    const Vec3 &a = curve.places[i].position, &b = curve.places[(i + 1) % n].position;
    summed.push_back(summed.back() + Distance(a, b) / field.At(0.5 * (a + b)));
  }
  const size_t count = std::max(kFewestPoints, static_cast<size_t>(std::llround(summed.back())));
  OrientedLoop loop;
  size_t at = 0;
  for (size_t k = 0; k < count; ++k) {
    const double wanted = summed.back() * static_cast<double>(k) / static_cast<double>(count);
    while (at + 1 < n && summed[at + 1] <= wanted) ++at;
    const double part = (wanted - summed[at]) / (summed[at + 1] - summed[at]);
    SourcePoint p = curve.places[at];
    p.position = Lerp(p.position, curve.places[(at + 1) % n].position, part);
    const std::optional<SourcePoint> found = FindRimPlace(surface, p);
    loop.points.push_back(found ? *found : curve.places[at]);
  }
  return loop;
}

}  // namespace

std::vector<OrientedLoop> RimLoops(const PointSurface& surface, absl::Span<const RimCurve> curves,
                                   const GuidanceField& field) {
  std::vector<OrientedLoop> loops;
  for (const RimCurve& curve : curves) loops.push_back(Resample(surface, curve, field));
  return loops;
}

}  // namespace meshfront
