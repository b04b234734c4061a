// Shape of triangles: radius ratios, angles, edge lengths, valences.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "core/mesh/triangle_mesh.h"

namespace meshfront {

// Percentiles interpolate linearly between ranks. A mesh without triangles has zeros everywhere.
struct QualityReport {
  uint64_t triangles = 0;
  // Radius ratio q = 2r/R: 1 equilateral, 0 degenerate.
  double radius_ratio_min = 0, radius_ratio_p0_5 = 0, radius_ratio_median = 0, radius_ratio_mean = 0;
  double min_angle_deg = 0;             // the smallest angle of all
  double share_min_angle_below_30 = 0;  // of triangles, 0 … 1
  // Only of whole meshes (MeasureQuality), not of a stream:
  double incident_edge_ratio_max = 0;  // longest over shortest edge at a vertex; +infinity where an edge has length 0
  std::vector<uint64_t> valence_histogram;  // [n]: inner vertices with n edges, all with two faces
  double edge_length_min = 0, edge_length_median = 0, edge_length_max = 0;  // over distinct edges
};

// O(n log n). Triangles with a corner that is not finite are left out; those with a repeated index count as degenerate.
QualityReport MeasureQuality(const TriangleMesh& mesh);

// The same for triangles that come one by one and are not kept: 128 kB, whatever their number. Minimum, mean and share
// are exact; percentiles of the radius ratio are right to a bin of 6e-5, or
// the gap between neighbours in rank. The result is a function of the sequence of triangles.
class QualityAccumulator {
 public:
  QualityAccumulator();
  void Add(const Vec3& a, const Vec3& b, const Vec3& c);  // 15 ns
  QualityReport Report() const;

 private:
  double Percentile(double share) const;

  std::vector<uint64_t> bins_;  // of the radius ratio, 0 … 1
  uint64_t count_ = 0, below_30_ = 0;
  double min_ratio_ = 1, max_ratio_ = 0, sum_ = 0;
  double min_tangent_ = std::numeric_limits<double>::infinity();  // of the smallest angle
};

}  // namespace meshfront
