// A cloud around a surface looks like a ball near by and like a plane from farther away: neighbours are doubled until the
// median of what they measure across their plane is small against along it. An edge looks the same at any distance, but most
// points lie at none.
#include "core/mesh/point_noise.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "Eigen/Eigenvalues"

namespace meshfront {
namespace {

constexpr size_t kFewestNeighbours = 12, kMostNeighbours = 192;
constexpr size_t kAsked = 1024;
// What is lower than this part of its width is flat.
constexpr double kFlat = 0.3;

double Median(std::vector<double>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

NeighbourPlane FitNeighbourPlane(absl::Span<const Vec3> positions, absl::Span<const uint32_t> neighbours) {
  Vec3 mean;
  for (const uint32_t i : neighbours) mean += positions[i];
  mean = mean / static_cast<double>(neighbours.size());
  double scale = 0;
  for (const uint32_t i : neighbours) scale = std::max(scale, Distance(positions[i], mean));
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const uint32_t i : neighbours) {
    if (!(scale > 0)) break;
    const Vec3 d = (positions[i] - mean) / scale;
    const Eigen::Vector3d e(d.x, d.y, d.z);
    spread += e * e.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(spread);
  const Eigen::Vector3d n = solver.eigenvectors().col(0);
  const auto root_mean_square = [&](int axis) {
    return scale * std::sqrt(std::max(solver.eigenvalues()[axis], 0.0) / static_cast<double>(neighbours.size()));
  };
  return {Normalized(Vec3{n.x(), n.y(), n.z()}), root_mean_square(0), root_mean_square(1), root_mean_square(2)};
}

PointNoise MeasurePointNoise(absl::Span<const Vec3> positions) {
  return MeasurePointNoise(positions, PointTree(positions));
}

PointNoise MeasurePointNoise(absl::Span<const Vec3> positions, const PointTree& tree) {
  const size_t n = positions.size(), stride = n / kAsked + 1;
  PointNoise best;
  double least = 0;
  std::vector<std::pair<double, uint32_t>> found;
  std::vector<uint32_t> list;
  for (size_t k = std::min(kFewestNeighbours, n - 1);; k *= 2) {
    std::vector<double> flatness, across, spacing;
    for (size_t i = 0; i < n; i += stride) {
      tree.FindNearest(positions[i], k + 1, found);
      list.clear();
      for (const auto& entry : found) list.push_back(entry.second);
      const NeighbourPlane plane = FitNeighbourPlane(positions, list);
      flatness.push_back(plane.along > 0 ? plane.across / plane.along : 1);
      across.push_back(plane.across);
      spacing.push_back(std::sqrt(std::numbers::pi * found.back().first / static_cast<double>(k)));
    }
    const double flat = Median(flatness);
    if (best.neighbours == 0 || flat < least) best = {Median(spacing), Median(across), flat, k}, least = flat;
    if (flat <= kFlat || 2 * k > std::min(kMostNeighbours, n / 4)) break;
  }
  return best;
}

}  // namespace meshfront
