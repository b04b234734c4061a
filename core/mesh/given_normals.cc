// Noise of normals is judged by what neighbours say of each other, since no single plane is right: at an edge it is the plane that
// errs, and on few points of a bent surface all of them do. Rejected: the angle to the plane alone; it is as large there.
#include "core/mesh/given_normals.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <utility>
#include <vector>

#include "core/mesh/point_noise.h"

namespace meshfront {
namespace {

constexpr size_t kAsked = 1024;
constexpr size_t kGrain = 256;
// Degrees between normals and planes that are no matter, and how many times as much normals may differ as planes do.
constexpr double kMostFromPlanes = 15, kMostPerPlanes = 2;

double AngleBetweenLines(const Vec3& a, const Vec3& b) {
  return std::acos(std::min(1.0, std::abs(Dot(a, b)))) * (180 / std::numbers::pi);
}

double Median(std::vector<double>& values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// The normal of the plane through a point and its neighbours, and the nearest of them.
struct LocalPlane {
  Vec3 normal;
  uint32_t nearest = PointTree::kNone;
};

LocalPlane PlaneAt(const TriangleMesh& points, const PointTree& tree, uint32_t i, size_t neighbours) {
  std::vector<std::pair<double, uint32_t>> found;
  tree.FindNearest(points.positions[i], neighbours + 1, found);
  LocalPlane plane;
  std::vector<uint32_t> around;
  for (const auto& entry : found) {
    around.push_back(entry.second);
    if (entry.second != i && plane.nearest == PointTree::kNone) plane.nearest = entry.second;
  }
  plane.normal = FitNeighbourPlane(points.positions, around).normal;
  return plane;
}

}  // namespace

bool NormalNoise::AreWorseThanPlanes() const {
  return from_planes > kMostFromPlanes && between_given > kMostPerPlanes * between_planes;
}

NormalNoise MeasureNormalNoise(const TriangleMesh& points, const PointTree& tree, size_t plane_neighbours) {
  const size_t n = points.positions.size(), stride = n / kAsked + 1;
  std::vector<double> from_planes, between_given, between_planes;
  for (uint32_t i = 0; i < n; i += static_cast<uint32_t>(stride)) {
    if (points.normals[i] == Vec3{}) continue;
    const LocalPlane own = PlaneAt(points, tree, i, plane_neighbours);
    if (own.nearest == PointTree::kNone || points.normals[own.nearest] == Vec3{}) continue;
    from_planes.push_back(AngleBetweenLines(points.normals[i], own.normal));
    between_given.push_back(AngleBetweenLines(points.normals[i], points.normals[own.nearest]));
    between_planes.push_back(
        AngleBetweenLines(own.normal, PlaneAt(points, tree, own.nearest, plane_neighbours).normal));
  }
  return {Median(from_planes), Median(between_given), Median(between_planes)};
}

absl::Status ReplaceByPlaneNormals(TriangleMesh& points, const PointTree& tree, size_t plane_neighbours,
                                   const Context& context) {
  return ParallelFor(points.positions.size(), kGrain, context, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      Vec3& given = points.normals[i];
      if (given == Vec3{}) continue;
      const Vec3 normal = PlaneAt(points, tree, static_cast<uint32_t>(i), plane_neighbours).normal;
      given = Dot(normal, given) < 0 ? -normal : normal;
    }
  });
}

}  // namespace meshfront
