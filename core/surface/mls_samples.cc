// 1. samples in the order of a tree    2. MeasureSpacing  spacing, supports and components by the nearest neighbours 3.
// MakePatches  the leaves of the tree, divided where normals disagree    4. ListPatches  who has a say in each
// Rejected: a search at each evaluation; it takes as long as the evaluation. Rejected: a list for each sample; eight
// times the memory.
#include "core/surface/mls_samples.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <queue>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/status_macros.h"
#include "core/surface/tolerances.h"

namespace meshfront {
namespace {

using namespace surface_tolerances;

constexpr size_t kGrain = 512;
constexpr double kPi = 3.14159265358979323846;

bool Agree(const Vec3& a, const Vec3& b) { return Dot(a, b) > kOpposed; }
// Neighbours may lie on both sides of an edge, but not of a sheet.
bool AreLinked(const MlsSample& a, const MlsSample& b) { return Dot(a.normal, b.normal) > kLinked; }

}  // namespace

absl::StatusOr<std::unique_ptr<MlsSamples>> MlsSamples::Create(absl::Span<const Vec3> positions,
                                                               absl::Span<const Vec3> normals, double radius,
                                                               const Context& context, size_t neighbours,
                                                               MlsWeights weights) {
  const size_t n = positions.size();
  const Widths widths{std::vector<double>(n, 1.0), std::vector<double>(n, 0.0)};
  return Make(positions, normals, widths, {radius, neighbours, weights}, context);
}

std::vector<Vec3> MlsSamples::Normals() const {
  std::vector<Vec3> normals;
  for (const MlsSample& s : samples_) normals.push_back(s.normal);
  return normals;
}

// Of each sample: 1 at a place, and less until some supports away from it. Smooth in between, so that the surface stays so.
std::vector<double> MlsSamples::SharesAround(absl::Span<const Vec3> places) const {
  std::vector<double> shares(samples_.size(), 0);
  for (const Vec3& place : places) {
    const uint32_t nearest = tree_->FindNearest(place, std::numeric_limits<double>::infinity(),
                                                [&](uint32_t i) { return components_[i] != kStray; });
    if (nearest == PointTree::kNone) continue;
    const double reach = kWidenedReach * samples_[nearest].support;
    Box3 box;
    box.Extend(place);
    tree_->VisitNear(
        box, [&](uint32_t) { return reach; },
        [&](uint32_t i) {
          const double t2 = SquaredDistance(positions_[i], place) / (reach * reach);
          if (t2 < 1) shares[i] = std::max(shares[i], (1 - t2) * (1 - t2));
        });
  }
  return shares;
}

absl::StatusOr<std::unique_ptr<MlsSamples>> MlsSamples::Widened(absl::Span<const Vec3> places, double factor,
                                                                double most, const Context& context) const {
  Widths widths = widths_;
  const std::vector<double> shares = places.empty() ? std::vector<double>(samples_.size(), 1.0) : SharesAround(places);
  for (size_t i = 0; i < shares.size(); ++i) {
    double& width = widths.supports[i];
    width = std::min(width * (1 + (factor - 1) * shares[i]), std::max(width, most / measures_.radius));
  }
  return Make(positions_, Normals(), widths, measures_, context);
}

absl::StatusOr<std::unique_ptr<MlsSamples>> MlsSamples::Rounded(absl::Span<const Vec3> places,
                                                                const Context& context) const {
  Widths widths = widths_;
  const std::vector<double> shares = places.empty() ? std::vector<double>(samples_.size(), 1.0) : SharesAround(places);
  bool is_any_narrow = false;
  for (size_t i = 0; i < shares.size(); ++i) {
    is_any_narrow |= shares[i] > 0 && samples_[i].Sharpness() > 0;
    widths.roundness[i] = std::max(widths.roundness[i], shares[i]);
  }
  if (!is_any_narrow) return nullptr;
  return Make(positions_, Normals(), widths, measures_, context);
}

absl::StatusOr<std::unique_ptr<MlsSamples>> MlsSamples::With(absl::Span<const Vec3> positions,
                                                             absl::Span<const Vec3> normals,
                                                             const Context& context) const {
  std::vector<Vec3> all = positions_, all_normals = Normals();
  Widths widths = widths_;
  for (const Vec3& x : positions) {
    const uint32_t nearest =
        tree_->FindNearest(x, std::numeric_limits<double>::infinity(), [](uint32_t) { return true; });
    widths.supports.push_back(widths_.supports[nearest]);
    widths.roundness.push_back(widths_.roundness[nearest]);
  }
  all.insert(all.end(), positions.begin(), positions.end());
  all_normals.insert(all_normals.end(), normals.begin(), normals.end());
  return Make(all, all_normals, widths, measures_, context);
}

absl::StatusOr<std::unique_ptr<MlsSamples>> MlsSamples::Make(absl::Span<const Vec3> positions,
                                                             absl::Span<const Vec3> normals, const Widths& widths,
                                                             const Measures& measures, const Context& context) {
  if (positions.size() < kLeastMlsSamples || positions.size() != normals.size()) {
    return absl::InvalidArgumentError(absl::StrCat("the point set has ", positions.size(), " points and ",
                                                   normals.size(), " normals; it must have at least ", kLeastMlsSamples,
                                                   " points and a normal for each"));
  }
  for (size_t i = 0; i < positions.size(); ++i) {
    if (!IsFinite(positions[i]) || !IsFinite(normals[i]))
      return absl::InvalidArgumentError(absl::StrCat("point ", i, " has a place or a normal that is not finite"));
  }
  std::unique_ptr<MlsSamples> made(new MlsSamples);
  made->measures_ = measures;
  made->samples_.reserve(positions.size());
  made->positions_.reserve(positions.size());
  const PointTree tree(positions);
  for (const uint32_t i : tree.order()) {
    made->samples_.push_back({positions[i], normals[i], 0, 0});
    made->positions_.push_back(positions[i]);
    made->widths_.supports.push_back(widths.supports[i]);
    made->widths_.roundness.push_back(widths.roundness[i]);
  }
  made->tree_ = std::make_unique<PointTree>(made->positions_);
  MESHFRONT_RETURN_IF_ERROR(made->MeasureSpacing(context));
  made->MakePatches();
  MESHFRONT_RETURN_IF_ERROR(made->ListPatches(context));
  return made;
}

// The square of a spacing is the area of the disc that k neighbours fill, by their number. Of neighbours on the other
// side of a thin sheet only the others count.
absl::Status MlsSamples::MeasureSpacing(const Context& context) {
  const size_t n = samples_.size(), k = std::min<size_t>(kSpacingNeighbours, n - 1);
  const size_t counted = std::clamp<size_t>(measures_.neighbours, k, n - 1);
  std::vector<uint32_t>& neighbours = neighbours_;
  neighbours.resize(n * k);
  neighbours_each_ = k;
  areas_.resize(n);
  MESHFRONT_RETURN_IF_ERROR(ParallelFor(n, kGrain, context, [&](size_t begin, size_t end) {
    std::vector<std::pair<double, uint32_t>> found;
    for (size_t i = begin; i < end; ++i) {
      tree_->FindNearest(positions_[i], counted + 1, found);
      size_t at = 0, agreeing = 0;
      for (const auto& [distance, j] : found) {
        if (j == i) continue;
        if (at < k) neighbours[i * k + at++] = j;
        agreeing += AreLinked(samples_[i], samples_[j]);
      }
      areas_[i] = kPi * found.back().first / static_cast<double>(std::max<size_t>(agreeing, 1));
    }
  }));
  UnionFind sets(n);
  for (size_t i = 0; i < n; ++i) {
    double sum = std::sqrt(areas_[i]);
    for (size_t at = 0; at < k; ++at) sum += std::sqrt(areas_[neighbours[i * k + at]]);
    samples_[i].support = widths_.supports[i] * measures_.radius * sum / static_cast<double>(k + 1);
  }
  for (uint32_t i = 0; i < n; ++i) {
    for (size_t at = 0; at < k; ++at) {
      const uint32_t j = neighbours[i * k + at];
      const double reach = std::min(samples_[i].support, samples_[j].support);
      if (SquaredDistance(positions_[i], positions_[j]) <= reach * reach && AreLinked(samples_[i], samples_[j]))
        sets.Unite(i, j);
    }
  }
  NumberComponents(sets);
  SetRadii();
  return absl::OkStatus();
}

// How far off a sample's plane its neighbours lie on average, in parts of the spacing, and of that the root of the mean square among
// them: where it is clearly more than at most samples, the surface bends there by more than the points are noisy. Not where supports
// were widened, which somebody had a reason for.
void MlsSamples::SetRadii() {
  for (MlsSample& s : samples_) s.inverse_squared_radius = s.support > 0 ? 1 / (s.support * s.support) : 0;
  if (measures_.weights == MlsWeights::kWide) return;
  const size_t n = samples_.size(), k = neighbours_each_;
  std::vector<double> bends(n, 0), around(n, 0);
  for (uint32_t i = 0; i < n; ++i) {
    if (components_[i] == kStray) continue;
    double height = 0, count = 0;
    for (size_t at = i * k; at < (i + 1) * k; ++at) {
      if (!AreLinked(samples_[i], samples_[neighbours_[at]])) continue;
      height += Dot(samples_[i].normal, positions_[neighbours_[at]] - positions_[i]), count += 1;
    }
    if (count > 0) bends[i] = height / (count * SpacingAt(i));
  }
  for (size_t i = 0; i < n; ++i) {
    around[i] = bends[i] * bends[i];
    for (size_t at = i * k; at < (i + 1) * k; ++at) around[i] += bends[neighbours_[at]] * bends[neighbours_[at]];
    around[i] = std::sqrt(around[i] / static_cast<double>(k + 1));
  }
  std::vector<double> sorted = around;
  std::nth_element(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(n / 2), sorted.end());
  const double flat = std::max(kLeastSharpBend, kSharpBendPerMedian * sorted[n / 2]);
  for (size_t i = 0; i < n; ++i) {
    MlsSample& s = samples_[i];
    if (!(s.support > 0)) continue;
    const double most = widths_.supports[i] > 1 ? 0 : 1 - widths_.roundness[i];
    const double share = std::min(most, std::clamp((around[i] / flat - 1) / kSharpBendRange, 0.0, 1.0));
    const double radius = (1 - (1 - kNarrowestRadius) * share) * s.support;
    s.inverse_squared_radius = 1 / (radius * radius);
  }
}

void MlsSamples::NumberComponents(UnionFind& sets) {
  const auto n = static_cast<uint32_t>(samples_.size());
  std::vector<uint32_t> sizes(n, 0);
  for (uint32_t i = 0; i < n; ++i) ++sizes[sets.Find(i)];
  components_.resize(n);
  for (uint32_t i = 0; i < n; ++i) {
    const uint32_t root = sets.Find(i);  // the smallest
    if (sizes[root] < std::max(kLeastComponent, measures_.neighbours / kNeighboursPerLeast)) {
      components_[i] = kStray, samples_[i].support = 0, areas_[i] = 0;
      ++stray_count_;
    } else {
      components_[i] = root == i ? component_count_++ : components_[root];
    }
  }
}

void MlsSamples::MakePatches() {
  patch_of_.assign(samples_.size(), PointTree::kNone);
  members_.reserve(samples_.size());
  for (const PointTree::Node& leaf : tree_->nodes()) {
    if (!leaf.is_leaf()) continue;
    for (uint32_t first = leaf.begin; first < leaf.end; ++first) {
      const uint32_t chief = tree_->order()[first];
      if (patch_of_[chief] != PointTree::kNone || components_[chief] == kStray) continue;
      Patch patch;
      patch.normal = samples_[chief].normal;
      patch.first_member = static_cast<uint32_t>(members_.size());
      for (uint32_t at = first; at < leaf.end; ++at) {
        const uint32_t i = tree_->order()[at];
        if (patch_of_[i] != PointTree::kNone || components_[i] == kStray ||
            Dot(samples_[i].normal, patch.normal) < kSamePatch)
          continue;
        patch_of_[i] = static_cast<uint32_t>(patches_.size());
        members_.push_back(i);
        patch.box.Extend(positions_[i]);
        patch.margin += kPatchMargin * samples_[i].support;
      }
      patch.member_count = static_cast<uint32_t>(members_.size()) - patch.first_member;
      patch.margin /= patch.member_count;
      patches_.push_back(patch);
    }
  }
}

// All whose supports reach the patch's box or its margin.
void MlsSamples::FindNear(const Patch& patch, const std::vector<double>& reach, std::vector<uint32_t>& near) const {
  near.clear();
  tree_->VisitNear(
      patch.box, [&](uint32_t node) { return reach[node] + patch.margin; },
      [&](uint32_t i) {
        const double r = samples_[i].support + patch.margin;
        if (components_[i] != kStray && patch.box.SquaredDistanceTo(positions_[i]) <= r * r) near.push_back(i);
      });
  std::sort(near.begin(), near.end());
}

// Those whose normals do not point the other way, and those that do but lie around an edge: not much farther along the
// surface, from neighbour to neighbour, than a support is wide.
void MlsSamples::KeepOwnSide(const Patch& patch, const std::vector<uint32_t>& near, std::vector<uint32_t>& list) const {
  const auto is_opposed = [&](uint32_t i) { return !Agree(samples_[i].normal, patch.normal); };
  if (std::none_of(near.begin(), near.end(), is_opposed)) {
    list.insert(list.end(), near.begin(), near.end());
    return;
  }
  std::vector<double> ways(near.size(), std::numeric_limits<double>::infinity());
  std::priority_queue<std::pair<double, size_t>, std::vector<std::pair<double, size_t>>, std::greater<>> queue;
  const auto reach_from = [&](double way, uint32_t i) {
    const auto found = std::lower_bound(near.begin(), near.end(), i);
    if (found == near.end() || *found != i) return;
    const auto at = static_cast<size_t>(found - near.begin());
    if (way >= ways[at] || way > kMostWayPerSupport * samples_[i].support) return;
    ways[at] = way;
    queue.push({way, at});
  };
  for (uint32_t m = 0; m < patch.member_count; ++m) reach_from(0, members_[patch.first_member + m]);
  while (!queue.empty()) {
    const auto [way, at] = queue.top();
    queue.pop();
    if (way > ways[at]) continue;
    const uint32_t i = near[at];
    for (size_t k = 0; k < neighbours_each_; ++k) {
      const uint32_t j = neighbours_[i * neighbours_each_ + k];
      if (AreLinked(samples_[i], samples_[j])) reach_from(way + Distance(positions_[i], positions_[j]), j);
    }
  }
  for (size_t at = 0; at < near.size(); ++at)
    if (!is_opposed(near[at]) || std::isfinite(ways[at])) list.push_back(near[at]);
}

absl::Status MlsSamples::ListPatches(const Context& context) {
  const absl::Span<const PointTree::Node> nodes = tree_->nodes();
  std::vector<double> reach(nodes.size(), 0);
  for (size_t at = nodes.size(); at-- > 0;) {
    if (!nodes[at].is_leaf()) {
      reach[at] = std::max(reach[at + 1], reach[nodes[at].right]);
      continue;
    }
    for (uint32_t i = nodes[at].begin; i < nodes[at].end; ++i)
      reach[at] = std::max(reach[at], samples_[tree_->order()[i]].support);
  }
  const size_t blocks = (patches_.size() + kGrain - 1) / kGrain;
  std::vector<std::vector<uint32_t>> lists(blocks);
  MESHFRONT_RETURN_IF_ERROR(ParallelFor(blocks, 1, context, [&](size_t begin, size_t end) {
    std::vector<uint32_t> near;
    for (size_t block = begin; block < end; ++block) {
      for (size_t p = block * kGrain; p < std::min(patches_.size(), (block + 1) * kGrain); ++p) {
        FindNear(patches_[p], reach, near);
        const size_t before = lists[block].size();
        KeepOwnSide(patches_[p], near, lists[block]);
        patches_[p].listed_count = static_cast<uint32_t>(lists[block].size() - before);
      }
    }
  }));
  std::vector<uint32_t>().swap(neighbours_);
  uint64_t total = 0;
  for (Patch& patch : patches_) patch.first_listed = total, total += patch.listed_count;
  lists_.reserve(total);
  for (std::vector<uint32_t>& list : lists) {
    lists_.insert(lists_.end(), list.begin(), list.end());
    std::vector<uint32_t>().swap(list);
  }
  return absl::OkStatus();
}

absl::Span<const uint32_t> MlsSamples::MembersOf(uint32_t patch) const {
  return {members_.data() + patches_[patch].first_member, patches_[patch].member_count};
}

absl::Span<const uint32_t> MlsSamples::ListOf(uint32_t patch) const {
  return {lists_.data() + patches_[patch].first_listed, patches_[patch].listed_count};
}

uint32_t MlsSamples::NearestLike(const Vec3& x, const Vec3& normal, double limit) const {
  return tree_->FindNearest(x, limit * limit, [&](uint32_t i) {
    return components_[i] != kStray && Dot(samples_[i].normal, normal) > kLikeNormal;
  });
}

uint32_t MlsSamples::PatchNear(const Vec3& x, const Vec3& normal, uint32_t patch) const {
  double limit = std::numeric_limits<double>::infinity();
  if (patch < patches_.size()) {
    const Patch& p = patches_[patch];
    const bool is_like = Dot(p.normal, normal) > kLikeNormal;
    const double distance2 = p.box.SquaredDistanceTo(x);
    if (distance2 <= p.margin * p.margin && is_like) return patch;
    limit = kFarthestPatch * (std::sqrt(distance2) + p.box.Diagonal() + p.margin / kPatchMargin);
  }
  const uint32_t nearest = NearestLike(x, normal, limit);
  if (nearest != PointTree::kNone) return patch_of_[nearest];
  return patch < patches_.size() ? patch : 0;
}

}  // namespace meshfront
