// Shape of triangles, gathered one by one in bounded memory.
#pragma once

#include <cstdint>
#include <vector>

#include "core/geometry/triangle.h"

namespace meshfront {

struct QualityReport {
  double radius_ratio_min = 0, radius_ratio_p0_5 = 0, radius_ratio_median = 0, radius_ratio_mean = 0;
  double min_angle_deg = 0;
};

// Histogram of radius ratios: the minimum is exact, percentiles to within 1/8192.
class QualityAccumulator {
 public:
  void Add(const Vec3& a, const Vec3& b, const Vec3& c);
  QualityReport Report() const;

 private:
  double PercentileAt(double share) const;
  static constexpr int kBins = 8192;
  std::vector<uint64_t> bins_ = std::vector<uint64_t>(kBins, 0);
  uint64_t count_ = 0;
  double min_ = 1, sum_ = 0, min_angle_ = 3;
};

}  // namespace meshfront
