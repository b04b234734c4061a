#include "core/mesh/quality.h"

#include <algorithm>
#include <numbers>

namespace meshfront {

void QualityAccumulator::Add(const Vec3& a, const Vec3& b, const Vec3& c) {
  const double q = RadiusRatio(a, b, c);
  ++bins_[std::clamp(static_cast<int>(q * kBins), 0, kBins - 1)];
  ++count_;
  sum_ += q;
  min_ = std::min(min_, q);
  min_angle_ = std::min(min_angle_, MinAngle(a, b, c));
}

double QualityAccumulator::PercentileAt(double share) const {
  const double rank = share * static_cast<double>(count_);
  double below = 0;
  for (int i = 0; i < kBins; ++i) {
    below += static_cast<double>(bins_[i]);
    if (below >= rank && below > 0) return (i + 0.5) / kBins;
  }
  return 0;
}

QualityReport QualityAccumulator::Report() const {
  if (count_ == 0) return {};
  return {min_, PercentileAt(0.005), PercentileAt(0.5), sum_ / static_cast<double>(count_),
          min_angle_ * 180 / std::numbers::pi};
}

}  // namespace meshfront
