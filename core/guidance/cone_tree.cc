// A query descends to the child whose cones could be lowest, keeps the other with its bound, and cuts off what cannot be below
// the best value so far (Fig. 7 as branch and bound):
//   1. the bound of a node is slope · distance to its box + lowest apex below it (BoundOf);
//   2. a leaf is scanned four cones at a time (MinOfLeaf).
// Rejected: Fig. 7 as printed, samples in order of distance. It stops at distance γ/(1 − 1/η), which looks at all cones inside
// a ball of six edge lengths; the apex heights in the nodes cut most of those off.
#include "core/guidance/cone_tree.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/guidance/tolerances.h"

namespace meshfront {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr int kLanes = 4;
// The median split halves, and indices have 32 bits, so no path is longer.
constexpr int kMaxDepth = 40;

int LongestAxis(const Box3& box) {
  const Vec3 extent = box.max - box.min;
  if (extent.x >= extent.y && extent.x >= extent.z) return 0;
  return extent.y >= extent.z ? 1 : 2;
}

}  // namespace

ConeTree::ConeTree(absl::Span<const Cone> cones, double slope, int leaf_size)
    : slope_(slope), leaf_size_(leaf_size), slots_(cones.size()) {
  if (cones.empty()) return;
  std::vector<Item> items(cones.size());
  for (uint32_t i = 0; i < cones.size(); ++i) items[i] = {cones[i].position, cones[i].apex, i};
  nodes_.reserve(4 * cones.size() / leaf_size + 2);
  blocks_.reserve(2 * cones.size() / kLanes + 2);
  nodes_.emplace_back();
  parents_.push_back(0);
  Build(0, absl::MakeSpan(items));
}

void ConeTree::Build(uint32_t node, absl::Span<Item> items) {
  Box3 box;
  double min_apex = kInfinity;
  for (const Item& item : items) {
    box.Extend(item.position);
    min_apex = std::min(min_apex, item.apex);
  }
  nodes_[node].box = box;
  nodes_[node].min_apex = min_apex;
  if (items.size() <= static_cast<size_t>(leaf_size_)) return MakeLeaf(node, items);
  const int axis = LongestAxis(box);
  const size_t half = items.size() / 2;
  std::nth_element(items.begin(), items.begin() + half, items.end(), [axis](const Item& a, const Item& b) {
    return a.position[axis] != b.position[axis] ? a.position[axis] < b.position[axis] : a.cone < b.cone;
  });
  const uint32_t left = static_cast<uint32_t>(nodes_.size());
  nodes_[node].first = left;
  nodes_.resize(left + 2);
  parents_.resize(left + 2, node);
  Build(left, items.first(half));
  Build(left + 1, items.subspan(half));
}

void ConeTree::MakeLeaf(uint32_t node, absl::Span<const Item> items) {
  nodes_[node].first = static_cast<uint32_t>(blocks_.size());
  nodes_[node].block_count = static_cast<uint32_t>((items.size() + kLanes - 1) / kLanes);
  for (size_t i = 0; i < items.size(); ++i) {
    const int lane = i % kLanes;
    if (lane == 0) {
      blocks_.emplace_back();
      std::fill_n(blocks_.back().apex, kLanes, kInfinity);
      leaves_.push_back(node);
    }
    Block& block = blocks_.back();
    block.x[lane] = items[i].position.x;
    block.y[lane] = items[i].position.y;
    block.z[lane] = items[i].position.z;
    block.apex[lane] = items[i].apex;
    slots_[items[i].cone] = static_cast<uint32_t>(kLanes * (blocks_.size() - 1) + lane);
  }
}

inline double ConeTree::BoundOf(const Node& node, const Vec3& x) const {
  return (slope_ * std::sqrt(node.box.SquaredDistanceTo(x)) + node.min_apex) * kPruneShrink;
}

inline double ConeTree::MinOfLeaf(const Node& leaf, const Vec3& x) const {
  double lowest[kLanes] = {kInfinity, kInfinity, kInfinity, kInfinity};
  for (uint32_t b = leaf.first; b != leaf.first + leaf.block_count; ++b) {
    const Block& block = blocks_[b];
    for (int i = 0; i < kLanes; ++i) {
      const double dx = x.x - block.x[i], dy = x.y - block.y[i], dz = x.z - block.z[i];
      const double height = slope_ * std::sqrt(dx * dx + dy * dy + dz * dz) + block.apex[i];
      lowest[i] = height < lowest[i] ? height : lowest[i];
    }
  }
  return std::min(std::min(lowest[0], lowest[1]), std::min(lowest[2], lowest[3]));
}

// The minimum below `root` if it is below `limit`; with `first_hit` the first value below `limit` that turns up.
double ConeTree::SearchBelow(uint32_t root, const Vec3& x, double limit, bool first_hit) const {
  Visit stack[kMaxDepth];
  int depth = 0;
  double best = kInfinity;
  Visit at{BoundOf(nodes_[root], x), root};
  while (true) {
    while (at.bound < limit) {
      const Node& node = nodes_[at.node];
      if (node.block_count > 0) {
        best = std::min(best, MinOfLeaf(node, x));
        if (best < limit) {
          if (first_hit) return best;
          limit = best;
        }
        break;
      }
      Visit near{BoundOf(nodes_[node.first], x), node.first};
      Visit far{BoundOf(nodes_[node.first + 1], x), node.first + 1};
      if (far.bound < near.bound) std::swap(near, far);
      if (far.bound < limit) stack[depth++] = far;
      at = near;
    }
    if (depth == 0) return best;
    at = stack[--depth];
  }
}

double ConeTree::MinAt(const Vec3& x, double limit) const {
  return nodes_.empty() ? kInfinity : SearchBelow(0, x, limit, false);
}

bool ConeTree::AnyAtMost(uint32_t except, double height) const {
  const uint32_t slot = slots_[except];
  const Block& block = blocks_[slot / kLanes];
  const int lane = slot % kLanes;
  const Vec3 x{block.x[lane], block.y[lane], block.z[lane]};
  const double limit = std::nextafter(height, kInfinity);  // at most = below the next number
  uint32_t node = leaves_[slot / kLanes];
  if (SearchBelow(node, x, limit, true) < limit) return true;
  while (node != 0) {
    const uint32_t parent = parents_[node];
    const uint32_t sibling = 2 * nodes_[parent].first + 1 - node;
    if (SearchBelow(sibling, x, limit, true) < limit) return true;
    node = parent;
  }
  return false;
}

void ConeTree::Activate(uint32_t cone, double apex) {
  const uint32_t slot = slots_[cone];
  blocks_[slot / kLanes].apex[slot % kLanes] = apex;
  uint32_t node = leaves_[slot / kLanes];
  while (nodes_[node].min_apex > apex) {
    nodes_[node].min_apex = apex;
    if (node == 0) break;
    node = parents_[node];
  }
}

}  // namespace meshfront
