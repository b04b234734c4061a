// 1. LinkNeighbours    2. SharpenNormals, where they are estimated    3. FindEdgeSamples: samples with a sharp link around which two
// fits are much better than one    4. DropShortEdges: those that hang together over a few spacings only
// Rejected: pieces as components of the whole graph of links. An edge that fades out has the same piece on both sides.
#include "core/mesh/point_pieces.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/base/status_macros.h"
#include "core/geometry/box.h"
#include "core/mesh/point_noise.h"
#include "core/mesh/union_find.h"

namespace meshfront {
namespace {

constexpr size_t kLinks = 12;
constexpr size_t kGrain = 256;
// Sides and their fits see so many spacings far.
constexpr double kReach = 5;
constexpr double kNearEdge = 7;  // beyond that round edges do not differ from sharp ones
constexpr size_t kFewestOfSide = 6;
// Where normals are estimated, samples farther from the fit than so many deviations are left out of it, in so many rounds.
constexpr double kOutlier = 2.5;
constexpr int kRefits = 3;
// A place may lie so many spacings beside the samples of the side that it lies on.
constexpr double kBesideSamples = 1;
// Two fits leave no more than this part of the noise, which is the median residual of fits at so many samples, and one fit leaves more
// than this part of what two do and of the noise. Lengths of so many spacings do not count.
constexpr double kNoisy = 1.5, kClearResidual = 1.8, kLeastResidual = 0.02;
constexpr size_t kAsked = 1024;
// Edges shorter than so many spacings are folds and noise of scans (the longest in 200,000 samples of bunny and igea was 26), unless two
// fits are so much better than one for most of their samples.
constexpr double kShortestEdge = 35, kShortestClearEdge = 10, kClearEdge = 10;
constexpr double kNoResidual = 1e-6;  // in spacings
// Planes for normals: so many samples each, of so many around; replaced where another is flatter by this factor.
constexpr size_t kPlaneSamples = 14, kPlanesTried = 40;
constexpr double kFlatter = 0.5, kExplained = 2, kFlatSlack = 0.005;

}  // namespace

PointPieces::PointPieces(absl::Span<const Vec3> positions, absl::Span<const Vec3> normals, double angle)
    : positions_(positions),
      normals_(normals.begin(), normals.end()),
      cosine_(std::cos(angle)),
      tree_(positions),
      clarity_(positions.size(), 0),
      is_edge_(positions.size(), 0) {}

absl::StatusOr<std::unique_ptr<PointPieces>> PointPieces::Create(absl::Span<const Vec3> positions,
                                                                 absl::Span<const Vec3> normals, double angle,
                                                                 bool are_estimated, const Context& context) {
  std::unique_ptr<PointPieces> pieces(new PointPieces(positions, normals, angle));
  MESHFRONT_RETURN_IF_ERROR(pieces->LinkNeighbours(context));
  pieces->are_estimated_ = are_estimated;
  if (are_estimated) MESHFRONT_RETURN_IF_ERROR(pieces->SharpenNormals(context));
  MESHFRONT_RETURN_IF_ERROR(pieces->FindEdgeSamples(context));
  pieces->DropShortEdges();
  return pieces;
}

absl::Status PointPieces::LinkNeighbours(const Context& context) {
  const size_t n = positions_.size();
  each_ = std::min(kLinks, n - 1);
  neighbours_.resize(n * each_);
  spacing_.resize(n);
  MESHFRONT_RETURN_IF_ERROR(ParallelFor(n, kGrain, context, [&](size_t begin, size_t end) {
    std::vector<std::pair<double, uint32_t>> found;
    for (size_t i = begin; i < end; ++i) {
      tree_.FindNearest(positions_[i], each_ + 1, found);
      size_t at = 0;
      for (const auto& entry : found) {
        if (entry.second != i && at < each_) neighbours_[i * each_ + at++] = entry.second;
      }
      spacing_[i] = std::sqrt(std::numbers::pi * found.back().first / static_cast<double>(each_));
    }
  }));
  std::vector<double> sorted = spacing_;
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(n / 2);
  std::nth_element(sorted.begin(), middle, sorted.end());
  median_spacing_ = *middle;
  for (const double s : spacing_) mean_area_ += s * s / static_cast<double>(n);
  return absl::OkStatus();
}

// The flattest of the planes around that a sample lies on is on its own side of the edge.
absl::Status PointPieces::SharpenNormals(const Context& context) {
  const size_t n = positions_.size(), k = std::min(kPlaneSamples, n - 1), tried = std::min(kPlanesTried, n - 1);
  struct Plane {
    Vec3 place, normal;
    double across = 0, along = 0;
  };
  std::vector<Plane> planes(n);
  MESHFRONT_RETURN_IF_ERROR(ParallelFor(n, kGrain, context, [&](size_t begin, size_t end) {
    std::vector<std::pair<double, uint32_t>> found;
    std::vector<uint32_t> around;
    for (size_t i = begin; i < end; ++i) {
      tree_.FindNearest(positions_[i], k + 1, found);
      around.clear();
      Vec3 mean;
      for (const auto& entry : found) around.push_back(entry.second), mean += positions_[entry.second];
      const NeighbourPlane plane = FitNeighbourPlane(positions_, around);
      planes[i] = {mean / static_cast<double>(found.size()), plane.normal, plane.across, plane.along};
    }
  }));
  std::vector<Vec3> sharpened = normals_;
  MESHFRONT_RETURN_IF_ERROR(ParallelFor(n, kGrain, context, [&](size_t begin, size_t end) {
    std::vector<std::pair<double, uint32_t>> found;
    for (size_t i = begin; i < end; ++i) {
      if (planes[i].across <= kFlatSlack * planes[i].along) continue;
      tree_.FindNearest(positions_[i], tried + 1, found);
      const Plane* best = &planes[i];
      for (const auto& entry : found) {
        const Plane& plane = planes[entry.second];
        const double off = std::abs(Dot(plane.normal, positions_[i] - plane.place));
        if (off > kExplained * plane.across + kFlatSlack * plane.along || plane.across >= best->across) continue;
        best = &plane;
      }
      if (best->across > kFlatter * planes[i].across) continue;
      sharpened[i] = Dot(best->normal, normals_[i]) < 0 ? -best->normal : best->normal;
    }
  }));
  normals_ = std::move(sharpened);
  return absl::OkStatus();
}

bool PointPieces::IsSmoothLink(uint32_t a, uint32_t b) const { return Dot(normals_[a], normals_[b]) > cosine_; }

bool PointPieces::HasSharpLink(uint32_t sample) const {
  for (size_t at = 0; at < each_; ++at) {
    if (!IsSmoothLink(sample, neighbours_[sample * each_ + at])) return true;
  }
  return false;
}

double PointPieces::SpacingAt(const Vec3& x) const {
  const uint32_t nearest = tree_.FindNearest(x, std::numeric_limits<double>::infinity(), [](uint32_t) { return true; });
  return spacing_[nearest];
}

bool PointPieces::IsNearEdge(const Vec3& x) const {
  const double reach = kNearEdge * SpacingAt(x);
  return tree_.FindNearest(x, reach * reach, [&](uint32_t i) { return is_edge_[i] != 0; }) != PointTree::kNone;
}

// Samples beside an edge may be on the wrong side, where normals are estimated.
void PointPieces::RefitWithoutOutliers(const Vec3& x, PointSide& side) const {
  std::vector<uint32_t> kept = side.members;
  for (int round = 0; round < kRefits; ++round) {
    const double most = kOutlier * std::sqrt(side.fit.residual2 / side.fit.weight);
    std::erase_if(kept, [&](uint32_t i) { return std::abs(side.fit.HeightAt(positions_[i])) > most; });
    if (2 * kept.size() < side.members.size() || kept.size() < kFewestOfSide) return;
    side.fit = FitSide(x, side.fit.radius, positions_, normals_, kept);
  }
}

std::vector<PointSide> PointPieces::SidesAt(const Vec3& x) const {
  const double spacing = SpacingAt(x), reach = kReach * spacing;
  std::vector<uint32_t> ball;
  tree_.VisitNear(
      Box3{x, x}, [&](uint32_t) { return reach; },
      [&](uint32_t i) {
        if (SquaredDistance(positions_[i], x) < reach * reach) ball.push_back(i);
      });
  std::sort(ball.begin(), ball.end());
  UnionFind sets(ball.size());
  for (uint32_t a = 0; a < ball.size(); ++a) {
    for (size_t at = 0; at < each_; ++at) {
      const uint32_t j = neighbours_[ball[a] * each_ + at];
      if (!IsSmoothLink(ball[a], j)) continue;
      const auto found = std::lower_bound(ball.begin(), ball.end(), j);
      if (found != ball.end() && *found == j) sets.Unite(a, static_cast<uint32_t>(found - ball.begin()));
    }
  }
  std::vector<PointSide> sides;
  std::vector<uint32_t> side_of(ball.size(), PointTree::kNone);
  for (uint32_t a = 0; a < ball.size(); ++a) {
    uint32_t& side = side_of[sets.Find(a)];
    if (side == PointTree::kNone) side = static_cast<uint32_t>(sides.size()), sides.emplace_back();
    sides[side].members.push_back(ball[a]);
  }
  std::erase_if(sides, [](const PointSide& side) { return side.members.size() < kFewestOfSide; });
  for (PointSide& side : sides) {
    side.fit = FitSide(x, reach, positions_, normals_, side.members);
    if (are_estimated_) RefitWithoutOutliers(x, side);
    const Vec3 gradient = side.fit.GradientAt(x);
    const double height = side.fit.HeightAt(x) / Norm(gradient);
    const Vec3 foot = x - height * Normalized(gradient);
    double nearest2 = reach * reach;
    for (const uint32_t i : side.members) nearest2 = std::min(nearest2, SquaredDistance(positions_[i], foot));
    const double beside = std::max(0.0, std::sqrt(nearest2) - kBesideSamples * spacing);
    side.distance = std::sqrt(height * height + beside * beside);
  }
  return sides;
}

bool PointPieces::TurnAt(const Vec3& x, const SideFit& a, const SideFit& b) const {
  return Dot(Normalized(a.GradientAt(x)), Normalized(b.GradientAt(x))) < cosine_;
}

// How much better two fits explain what lies around a sample than one; 0 where it is no edge sample.
double PointPieces::EdgeClarity(uint32_t sample) const {
  if (!HasSharpLink(sample)) return 0;
  const Vec3& x = positions_[sample];
  const std::vector<PointSide> sides = SidesAt(x);
  const auto own = std::find_if(sides.begin(), sides.end(), [&](const PointSide& side) {
    return std::binary_search(side.members.begin(), side.members.end(), sample);
  });
  if (own == sides.end()) return 0;
  const double noise = noise_ * spacing_[sample], least = kLeastResidual * spacing_[sample];
  for (const PointSide& other : sides) {
    if (&other == &*own || !TurnAt(x, own->fit, other.fit)) continue;
    std::vector<uint32_t> both = own->members;
    both.insert(both.end(), other.members.begin(), other.members.end());
    const SideFit joint = FitSide(x, own->fit.radius, positions_, normals_, both);
    const double one = std::sqrt(joint.residual2 / joint.weight);
    const double two = std::sqrt((own->fit.residual2 + other.fit.residual2) / (own->fit.weight + other.fit.weight));
    if (two <= kNoisy * noise + least && one > kClearResidual * std::max(two, noise) + least)
      return one / std::max(two, kNoResidual * spacing_[sample]);
  }
  return 0;
}

// The median residual of the fits at samples, in spacings.
void PointPieces::MeasureNoise() {
  std::vector<double> residuals;
  for (uint32_t i = 0; i < positions_.size(); i += static_cast<uint32_t>(positions_.size() / kAsked + 1)) {
    for (const PointSide& side : SidesAt(positions_[i])) {
      if (!std::binary_search(side.members.begin(), side.members.end(), i)) continue;
      residuals.push_back(std::sqrt(side.fit.residual2 / side.fit.weight) / spacing_[i]);
    }
  }
  if (residuals.empty()) return;
  const auto middle = residuals.begin() + static_cast<std::ptrdiff_t>(residuals.size() / 2);
  std::nth_element(residuals.begin(), middle, residuals.end());
  noise_ = *middle;
}

absl::Status PointPieces::FindEdgeSamples(const Context& context) {
  MeasureNoise();
  return ParallelFor(positions_.size(), kGrain, context, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) clarity_[i] = EdgeClarity(static_cast<uint32_t>(i));
  });
}

void PointPieces::DropShortEdges() {
  const auto n = static_cast<uint32_t>(positions_.size());
  UnionFind sets(n);
  for (uint32_t i = 0; i < n; ++i) {
    for (size_t at = 0; at < each_ && clarity_[i] > 0; ++at) {
      const uint32_t j = neighbours_[i * each_ + at];
      if (clarity_[j] > 0) sets.Unite(i, j);
    }
  }
  std::vector<Box3> boxes(n);
  std::vector<int64_t> clear(n, 0);  // samples that are so less those that are not
  std::vector<double> counts(n, 0), spacings(n, 0);
  for (uint32_t i = 0; i < n; ++i) {
    if (clarity_[i] == 0) continue;
    boxes[sets.Find(i)].Extend(positions_[i]);
    clear[sets.Find(i)] += clarity_[i] >= kClearEdge ? 1 : -1;
    counts[sets.Find(i)] += 1, spacings[sets.Find(i)] += spacing_[i];
  }
  for (uint32_t i = 0; i < n; ++i) {
    if (clarity_[i] == 0) continue;
    const uint32_t edge = sets.Find(i);
    const double shortest = clear[edge] > 0 ? kShortestClearEdge : kShortestEdge;
    is_edge_[i] = boxes[edge].Diagonal() > shortest * spacings[edge] / counts[edge];
    has_edges_ = has_edges_ || is_edge_[i];
  }
}

}  // namespace meshfront
