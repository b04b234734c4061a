// 1. what is not finite    2. duplicates, of which the first stays    3. outliers, by the distance to their neighbours
// in parts of what that is for those    4. normals (point_normals.cc) Rejected: outliers by the mean and the deviation
// of all distances; where density varies they are whole regions.
#include "core/mesh/point_repair.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/status_macros.h"
#include "core/geometry/point_tree.h"
#include "core/mesh/point_sides.h"

namespace meshfront {
namespace {

constexpr size_t kFewestPoints = 4;
constexpr double kLargestCoordinate = 1e150;
// An outlier's distance to its neighbours in parts of the median of theirs; a scan's density changes by less from one
// to the next.
constexpr size_t kOutlierNeighbours = 8;
constexpr double kOutlierDistance = 6;
// Neighbours that are no more in doubt than this are on the same side, or a normal is on the wrong one; and the part of
// them beyond which that is no accident.
constexpr double kClearSides = 0.3, kMixedSides = 0.005;
// Points are on a line when they spread across it by less than this part of along it; and fill a volume when they do so
// across the planes through their neighbours by more than this part, of a ball 0.8, where there are enough to tell.
constexpr double kLineWidth = 1e-6, kVolumeFlatness = 0.6;
constexpr size_t kFewestOfAVolume = 200;
constexpr size_t kGrain = 512;
// Of the planes that given normals are compared with.
constexpr size_t kPlaneNeighbours = 14;
constexpr double kUnitSlack = 1e-12;  // of a squared length: such normals keep their bits

void Keep(TriangleMesh& points, const std::vector<bool>& keep) {
  size_t at = 0;
  for (size_t i = 0; i < points.positions.size(); ++i) {
    if (!keep[i]) continue;
    points.positions[at] = points.positions[i];
    if (!points.normals.empty()) points.normals[at] = points.normals[i];
    ++at;
  }
  points.positions.resize(at);
  if (!points.normals.empty()) points.normals.resize(at);
}

std::vector<bool> FiniteOnes(const TriangleMesh& points) {
  std::vector<bool> keep;
  for (const Vec3& x : points.positions) {
    keep.push_back(IsFinite(x) && std::max({std::abs(x.x), std::abs(x.y), std::abs(x.z)}) <= kLargestCoordinate);
  }
  return keep;
}

std::vector<bool> FirstOnes(const TriangleMesh& points) {
  std::vector<uint32_t> order(points.positions.size());
  std::iota(order.begin(), order.end(), 0u);
  const auto key = [&](uint32_t i) {
    const Vec3& x = points.positions[i];
    return std::array<double, 3>{x.x + 0.0, x.y + 0.0, x.z + 0.0};
  };
  std::sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) {
    const auto x = key(a), y = key(b);
    return x != y ? x < y : a < b;
  });
  std::vector<bool> keep(order.size(), true);
  for (size_t i = 1; i < order.size(); ++i)
    if (key(order[i]) == key(order[i - 1])) keep[order[i]] = false;
  return keep;
}

struct Neighbourhoods {
  std::vector<bool> inliers;
  bool has_mixed_sides = false;  // normals of neighbours are on opposite sides
};

absl::StatusOr<Neighbourhoods> LookAround(const TriangleMesh& points, const PointTree& tree, const Context& context) {
  const size_t n = points.positions.size(), k = std::min(kOutlierNeighbours, n - 1);
  std::vector<double> distances(n);
  std::vector<uint32_t> neighbours(n * k);
  std::vector<uint8_t> clear(n, 0), opposed(n, 0);
  MESHFRONT_RETURN_IF_ERROR(ParallelFor(n, kGrain, context, [&](size_t begin, size_t end) {
    std::vector<std::pair<double, uint32_t>> found;
    for (size_t i = begin; i < end; ++i) {
      tree.FindNearest(points.positions[i], k + 1, found);
      size_t at = 0;
      for (const auto& [distance, j] : found) {
        if (j == i || at == k) continue;
        neighbours[i * k + at++] = j, distances[i] += std::sqrt(distance);
        if (points.normals[i] == Vec3{} || points.normals[j] == Vec3{}) continue;
        const SideComparison sides =
            CompareSides(points.positions[i], points.normals[i], points.positions[j], points.normals[j]);
        clear[i] += sides.doubt < kClearSides;
        opposed[i] += sides.doubt < kClearSides && sides.agreement < 0;
      }
    }
  }));
  std::vector<bool> keep(n);
  std::vector<double> theirs(k);
  for (size_t i = 0; i < n; ++i) {
    for (size_t at = 0; at < k; ++at) theirs[at] = distances[neighbours[i * k + at]];
    std::nth_element(theirs.begin(), theirs.begin() + static_cast<std::ptrdiff_t>(k / 2), theirs.end());
    keep[i] = distances[i] <= kOutlierDistance * theirs[k / 2];
  }
  const double all = std::accumulate(clear.begin(), clear.end(), 0.0);
  return Neighbourhoods{std::move(keep), std::accumulate(opposed.begin(), opposed.end(), 0.0) > kMixedSides * all};
}

// Drops what is not to be kept, or refuses to.
absl::Status Drop(const std::vector<bool>& keep, const std::string& what, bool change, PointRepair& result) {
  const auto first = std::find(keep.begin(), keep.end(), false);
  if (first == keep.end()) return absl::OkStatus();
  const auto count = static_cast<uint64_t>(std::count(keep.begin(), keep.end(), false));
  if (!change) {
    return absl::FailedPreconditionError(absl::StrCat("point ", first - keep.begin(), ", the first of ", count,
                                                      ", would have to go (", what, "), and repair is off"));
  }
  Keep(result.points, keep);
  result.actions.push_back({what, count});
  if (result.points.positions.size() >= kFewestPoints) return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrCat("the point set has ", result.points.positions.size(),
                                                 " usable points; it must have at least ", kFewestPoints));
}

// Zero where there is none.
void MakeUnitNormals(TriangleMesh& points) {
  if (points.normals.size() != points.positions.size()) points.normals.assign(points.positions.size(), Vec3{});
  for (Vec3& n : points.normals) {
    if (!IsFinite(n)) n = {};
    if (std::abs(SquaredNorm(n) - 1) > kUnitSlack) n = Normalized(n);
  }
}

absl::Status CheckIsNoLine(const TriangleMesh& points) {
  std::vector<uint32_t> all(points.positions.size());
  std::iota(all.begin(), all.end(), 0u);
  const NeighbourPlane plane = FitNeighbourPlane(points.positions, all);
  if (plane.along > kLineWidth * plane.longest) return absl::OkStatus();
  return absl::FailedPreconditionError(absl::StrCat("the ", all.size(), " points lie on a line through (",
                                                    points.positions[0].x, ", ", points.positions[0].y, ", ",
                                                    points.positions[0].z, "); they are no samples of a surface"));
}

absl::Status CheckIsNoVolume(const PointNoise& noise, size_t count) {
  if (count < kFewestOfAVolume || noise.flatness < kVolumeFlatness) return absl::OkStatus();
  return absl::FailedPreconditionError(absl::StrCat("the ", count, " points fill a volume: among ", noise.neighbours,
                                                    " neighbours they spread across the surface by ", noise.flatness,
                                                    " of what they do along it; they are no samples of a surface"));
}

}  // namespace

absl::StatusOr<PointRepair> RepairPoints(TriangleMesh points, bool change, const Context& context) {
  PointRepair result;
  result.points = std::move(points);
  if (result.points.positions.size() < kFewestPoints) {
    return absl::InvalidArgumentError(absl::StrCat("the point set has ", result.points.positions.size(),
                                                   " points; it must have at least ", kFewestPoints));
  }
  MESHFRONT_RETURN_IF_ERROR(Drop(FiniteOnes(result.points), "dropped_non_finite_points", change, result));
  MESHFRONT_RETURN_IF_ERROR(Drop(FirstOnes(result.points), "dropped_duplicate_points", change, result));
  TriangleMesh& kept = result.points;
  MakeUnitNormals(kept);
  bool has_mixed_sides = false;
  auto tree = std::make_unique<PointTree>(kept.positions);
  if (change) {
    const size_t before = kept.positions.size();
    MESHFRONT_ASSIGN_OR_RETURN(const Neighbourhoods around, LookAround(kept, *tree, context));
    MESHFRONT_RETURN_IF_ERROR(Drop(around.inliers, "dropped_outliers", change, result));
    if (kept.positions.size() != before) tree = std::make_unique<PointTree>(kept.positions);
    has_mixed_sides = around.has_mixed_sides;
  }
  const auto missing = static_cast<uint64_t>(std::count(kept.normals.begin(), kept.normals.end(), Vec3{}));
  MESHFRONT_RETURN_IF_ERROR(CheckIsNoLine(kept));
  result.noise = MeasurePointNoise(kept.positions, *tree);
  MESHFRONT_RETURN_IF_ERROR(CheckIsNoVolume(result.noise, kept.positions.size()));
  if (change && missing < kept.positions.size()) {
    const size_t neighbours = std::max(kPlaneNeighbours, result.noise.neighbours);
    result.normal_noise = MeasureNormalNoise(kept, *tree, neighbours);
    if (result.normal_noise.AreWorseThanPlanes()) {
      MESHFRONT_RETURN_IF_ERROR(ReplaceByPlaneNormals(kept, *tree, neighbours, context));
      result.actions.push_back({"replaced_normals", kept.positions.size() - missing});
      has_mixed_sides = true;
    }
  }
  if (missing == 0 && !has_mixed_sides) return result;
  MESHFRONT_ASSIGN_OR_RETURN(const SideReport sides,
                             EstimateNormals(kept, result.noise.neighbours, has_mixed_sides, context));
  result.undecided_pairs = sides.undecided_pairs;
  if (missing > 0) result.actions.push_back({"estimated_normals", missing});
  if (sides.turned > 0) result.actions.push_back({"turned_normals", sides.turned});
  return result;
}

}  // namespace meshfront
