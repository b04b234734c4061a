// A query descends to the child whose cones could be lowest, keeps the others with their bounds, and cuts off what cannot be
// below the best value so far (Fig. 7 as branch and bound):
//   1. the bound of a child is slope · distance to its box + lowest apex below it, four at a time (BoundChildren);
//   2. a leaf is scanned four cones at a time (MinOfLeaf).
// Rejected: Fig. 7 as printed, samples in order of distance. It stops at distance γ/(1 − 1/η), which looks at all cones inside
// a ball of six edge lengths; the apex heights in the nodes cut most of those off. Two children a node: 17 nodes and 4 leaves
// are seen by a query of a scanned model's field, and the nodes cost more than the leaves.
#include "core/guidance/cone_tree.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/processor.h"
#include "core/guidance/tolerances.h"

namespace meshfront {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr uint32_t kLeafBit = 0x80000000u;
constexpr uint32_t kNoLane = 4;  // skips none
// Every level divides by four down to the leaves, and indices have 32 bits: no path is longer than 17 nodes, each of which leaves
// at most three children waiting.
constexpr int kMaxWaiting = 64;

// Four doubles side by side. Each lane rounds as a scalar does, so vectors change no bit. Handed on by reference: vectors of the
// wider processors have no place among the arguments of functions for all.
typedef double Lanes __attribute__((vector_size(32)));
typedef double UnalignedLanes __attribute__((vector_size(32), aligned(8), may_alias));
inline const UnalignedLanes& LanesAt(const double* values) { return *reinterpret_cast<const UnalignedLanes*>(values); }
inline void TakeRoots(Lanes& values) {
  Lanes roots;
  for (int i = 0; i < 4; ++i) roots[i] = std::sqrt(values[i]);
  values = roots;
}

int LongestAxis(const Box3& box) {
  const Vec3 extent = box.max - box.min;
  if (extent.x >= extent.y && extent.x >= extent.z) return 0;
  return extent.y >= extent.z ? 1 : 2;
}

// Puts the lower half along the longest axis first; returns its size. Ties by index.
template <class Item>
size_t SplitAtMedian(absl::Span<Item> items) {
  Box3 box;
  for (const Item& item : items) box.Extend(item.position);
  const size_t half = items.size() / 2;
  const auto split_along = [&](double Vec3::*axis) {
    std::nth_element(items.begin(), items.begin() + half, items.end(), [axis](const Item& a, const Item& b) {
      return a.position.*axis != b.position.*axis ? a.position.*axis < b.position.*axis : a.cone < b.cone;
    });
  };
  constexpr double Vec3::*kAxes[] = {&Vec3::x, &Vec3::y, &Vec3::z};
  split_along(kAxes[LongestAxis(box)]);
  return half;
}

// Of a search: what is left to be looked at.
class Waiting {
 public:
  // On to the most promising child of a node below the limit, if there is one; the others wait. Without branches: which of the four stay
  // can't be foretold.
  inline bool Descend(const uint32_t* children, const double* bounds, double limit, uint32_t& at) {
    double lowest = limit;
    int first = count_;
    for (int i = 0; i < ConeBlock::kLanes; ++i) {
      parts_[count_] = {bounds[i], children[i]};
      first = bounds[i] < lowest ? count_ : first;
      lowest = bounds[i] < lowest ? bounds[i] : lowest;
      count_ += bounds[i] < limit;
    }
    if (!(lowest < limit)) return false;
    at = parts_[first].child;
    parts_[first] = parts_[--count_];
    return true;
  }
  // The next one below the limit. False: there is none.
  inline bool Next(double limit, uint32_t& at) {
    do {
      if (count_ == 0) return false;
      --count_;
    } while (!(parts_[count_].bound < limit));
    at = parts_[count_].child;
    return true;
  }

 private:
  struct {
    double bound;
    uint32_t child;
  } parts_[kMaxWaiting];
  int count_ = 0;
};

}  // namespace

ConeTree::ConeTree(std::vector<Cone> cones, double slope, int leaf_size)
    : slope_(slope), leaf_size_(leaf_size), slots_(cones.size()) {
  if (cones.empty()) return;
  std::vector<Item> items(cones.size());
  for (uint32_t i = 0; i < cones.size(); ++i) items[i] = {cones[i].position, cones[i].apex, i};
  cones = std::vector<Cone>();
  size_t nodes = 0, blocks = 0;
  CountFor(items.size(), nodes, blocks);
  nodes_.reserve(nodes), parents_.reserve(nodes);
  blocks_.reserve(blocks), leaf_of_.reserve(blocks);
  Build(absl::MakeSpan(items), {});
}

// Adds how many nodes and blocks Build makes of so many items: it splits by count alone.
void ConeTree::CountFor(size_t items, size_t& nodes, size_t& blocks) const {
  ++nodes;
  const size_t half = items > leaf_size_ ? items / 2 : items;
  for (const size_t part : {half, items - half}) {
    const size_t quarter = part > leaf_size_ ? part / 2 : part;
    for (const size_t child : {quarter, part - quarter}) {
      if (child > leaf_size_)
        CountFor(child, nodes, blocks);
      else
        blocks += (child + kLanes - 1) / kLanes;
    }
  }
}

// Makes the node of these items and all below it. Halves twice, except halves that are leaves already.
uint32_t ConeTree::Build(absl::Span<Item> items, const Place& place) {
  const uint32_t node = static_cast<uint32_t>(nodes_.size());
  std::fill_n(nodes_.emplace_back().min_apex, kLanes, kInfinity);
  parents_.push_back(place);
  uint32_t lane = 0;
  const size_t half = items.size() > leaf_size_ ? SplitAtMedian(items) : items.size();
  for (absl::Span<Item> part : {items.first(half), items.subspan(half)}) {
    if (part.empty()) continue;
    const size_t quarter = part.size() > leaf_size_ ? SplitAtMedian(part) : part.size();
    Attach({node, lane++}, part.first(quarter));
    if (quarter < part.size()) Attach({node, lane++}, part.subspan(quarter));
  }
  return node;
}

void ConeTree::Attach(const Place& place, absl::Span<Item> items) {
  Box3 box;
  double min_apex = kInfinity;
  for (const Item& item : items) {
    box.Extend(item.position);
    min_apex = std::min(min_apex, item.apex);
  }
  const uint32_t child = items.size() > leaf_size_ ? Build(items, place) : MakeLeaf(items, place);
  Node& node = nodes_[place.node];
  const uint32_t i = place.lane;
  node.min_x[i] = box.min.x, node.min_y[i] = box.min.y, node.min_z[i] = box.min.z;
  node.max_x[i] = box.max.x, node.max_y[i] = box.max.y, node.max_z[i] = box.max.z;
  node.min_apex[i] = min_apex;
  node.child[i] = child;
}

uint32_t ConeTree::MakeLeaf(absl::Span<const Item> items, const Place& place) {
  const uint32_t leaf = static_cast<uint32_t>(leaves_.size());
  leaves_.push_back(
      {static_cast<uint32_t>(blocks_.size()), static_cast<uint32_t>((items.size() + kLanes - 1) / kLanes), place});
  for (size_t i = 0; i < items.size(); ++i) {
    const int lane = i % kLanes;
    if (lane == 0) {
      std::fill_n(blocks_.emplace_back().apex, kLanes, kInfinity);
      leaf_of_.push_back(leaf);
    }
    Block& block = blocks_.back();
    block.x[lane] = items[i].position.x;
    block.y[lane] = items[i].position.y;
    block.z[lane] = items[i].position.z;
    block.apex[lane] = items[i].apex;
    slots_[items[i].cone] = static_cast<uint32_t>(kLanes * (blocks_.size() - 1) + lane);
  }
  return kLeafBit | leaf;
}

inline void ConeTree::BoundChildren(const Node& node, const Vec3& x, double bounds[kLanes]) const {
  const Lanes zero{};
  const auto distance_to_slab = [&](const double* min, const double* max, double at, Lanes& out) {
    const Lanes below = LanesAt(min) - at, above = at - LanesAt(max);
    out = below > above ? below : above;
    out = out > zero ? out : zero;
  };
  Lanes dx, dy, dz;
  distance_to_slab(node.min_x, node.max_x, x.x, dx);
  distance_to_slab(node.min_y, node.max_y, x.y, dy);
  distance_to_slab(node.min_z, node.max_z, x.z, dz);
  Lanes distance = dx * dx + dy * dy + dz * dz;
  TakeRoots(distance);
  const Lanes bound = (slope_ * distance + LanesAt(node.min_apex)) * kPruneShrink;
  for (int i = 0; i < kLanes; ++i) bounds[i] = bound[i];
}

inline double ConeTree::MinOfLeaf(const Leaf& leaf, const Vec3& x) const {
  Lanes lowest = {kInfinity, kInfinity, kInfinity, kInfinity};
  for (uint32_t b = leaf.first_block; b != leaf.first_block + leaf.block_count; ++b) {
    const Block& block = blocks_[b];
    const Lanes dx = x.x - LanesAt(block.x), dy = x.y - LanesAt(block.y), dz = x.z - LanesAt(block.z);
    Lanes height = dx * dx + dy * dy + dz * dz;
    TakeRoots(height);
    height = slope_ * height + LanesAt(block.apex);
    lowest = height < lowest ? height : lowest;
  }
  return std::min(std::min(lowest[0], lowest[1]), std::min(lowest[2], lowest[3]));
}

// The minimum below `root`, one of its lanes left out, if it is below `limit`; with `first_hit` the first value below `limit`
// that turns up.
MESHFRONT_WIDE double ConeTree::SearchBelow(uint32_t root, uint32_t skipped_lane, const Vec3& x, double limit,
                                            bool first_hit) const {
  Waiting waiting;
  double best = kInfinity;
  uint32_t at = root;
  while (true) {
    if (at & kLeafBit) {
      best = std::min(best, MinOfLeaf(leaves_[at ^ kLeafBit], x));
      if (first_hit && best < limit) return best;
      limit = std::min(limit, best);
    } else {
      double bounds[kLanes];
      BoundChildren(nodes_[at], x, bounds);
      if (skipped_lane != kNoLane) bounds[skipped_lane] = kInfinity;
      skipped_lane = kNoLane;
      if (waiting.Descend(nodes_[at].child, bounds, limit, at)) continue;
    }
    if (!waiting.Next(limit, at)) return best;
  }
}

double ConeTree::MinAt(const Vec3& x, double limit) const {
  return nodes_.empty() ? kInfinity : SearchBelow(0, kNoLane, x, limit, false);
}

// Like SearchBelow, but what comes near to the lowest is wanted as well. `limit` falls with that; what was taken before it did is
// sifted at the end.
MESHFRONT_WIDE bool ConeTree::Gather(const Vec3& center, double radius, double limit, ConePatch& patch) const {
  patch.blocks = 0;
  if (nodes_.empty()) return true;
  const double window = 2 * slope_ * radius;
  double lowest_of[ConePatch::kCapacity];
  Waiting waiting;
  uint32_t at = 0;
  while (true) {
    if (at & kLeafBit) {
      const Leaf& leaf = leaves_[at ^ kLeafBit];
      for (uint32_t b = leaf.first_block; b != leaf.first_block + leaf.block_count; ++b) {
        const Block& block = blocks_[b];
        const Lanes dx = center.x - LanesAt(block.x), dy = center.y - LanesAt(block.y),
                    dz = center.z - LanesAt(block.z);
        Lanes height = dx * dx + dy * dy + dz * dz;
        TakeRoots(height);
        height = slope_ * height + LanesAt(block.apex);
        const double lowest = std::min(std::min(height[0], height[1]), std::min(height[2], height[3]));
        if (!(lowest < limit)) continue;
        if (patch.blocks == ConePatch::kCapacity) return false;
        limit = std::min(limit, (lowest + window) * kPruneGrow);
        lowest_of[patch.blocks] = lowest;
        patch.block[patch.blocks++] = &block;
      }
    } else {
      double bounds[kLanes];
      BoundChildren(nodes_[at], center, bounds);
      if (waiting.Descend(nodes_[at].child, bounds, limit, at)) continue;
    }
    if (!waiting.Next(limit, at)) break;
  }
  int kept = 0;
  for (int i = 0; i < patch.blocks; ++i) {
    patch.block[kept] = patch.block[i];
    kept += lowest_of[i] < limit;
  }
  patch.blocks = kept;
  return true;
}

MESHFRONT_WIDE double ConeTree::MinOf(const ConePatch& patch, const Vec3& x) const {
  Lanes lowest = {kInfinity, kInfinity, kInfinity, kInfinity};
  for (int i = 0; i < patch.blocks; ++i) {
    const Block& block = *patch.block[i];
    const Lanes dx = x.x - LanesAt(block.x), dy = x.y - LanesAt(block.y), dz = x.z - LanesAt(block.z);
    Lanes height = dx * dx + dy * dy + dz * dz;
    TakeRoots(height);
    height = slope_ * height + LanesAt(block.apex);
    lowest = height < lowest ? height : lowest;
  }
  return std::min(std::min(lowest[0], lowest[1]), std::min(lowest[2], lowest[3]));
}

ConeTree ConeTree::WithApexes(absl::Span<const double> apexes) const {
  ConeTree tree = *this;
  for (size_t i = 0; i < apexes.size(); ++i) tree.blocks_[slots_[i] / kLanes].apex[slots_[i] % kLanes] = apexes[i];
  tree.FindMinApexes();
  return tree;
}

// Children come behind their parents.
void ConeTree::FindMinApexes() {
  for (Node& node : nodes_) std::fill_n(node.min_apex, kLanes, kInfinity);
  for (const Leaf& leaf : leaves_) {
    double& least = nodes_[leaf.place.node].min_apex[leaf.place.lane];
    for (uint32_t b = leaf.first_block; b != leaf.first_block + leaf.block_count; ++b)
      least = std::min(least, *std::min_element(blocks_[b].apex, blocks_[b].apex + kLanes));
  }
  for (size_t n = nodes_.size(); n-- > 1;) {
    double& least = nodes_[parents_[n].node].min_apex[parents_[n].lane];
    least = std::min(least, *std::min_element(nodes_[n].min_apex, nodes_[n].min_apex + kLanes));
  }
}

bool ConeTree::AnyAtMost(uint32_t except, double height) const {
  const uint32_t slot = slots_[except];
  const Block& block = blocks_[slot / kLanes];
  const int lane = slot % kLanes;
  const Vec3 x{block.x[lane], block.y[lane], block.z[lane]};
  const double limit = std::nextafter(height, kInfinity);  // at most = below the next number
  const Leaf& leaf = leaves_[leaf_of_[slot / kLanes]];
  if (MinOfLeaf(leaf, x) < limit) return true;
  for (Place place = leaf.place;; place = parents_[place.node]) {
    if (SearchBelow(place.node, place.lane, x, limit, true) < limit) return true;
    if (place.node == 0) return false;
  }
}

void ConeTree::Activate(uint32_t cone, double apex) {
  const uint32_t slot = slots_[cone];
  blocks_[slot / kLanes].apex[slot % kLanes] = apex;
  Place place = leaves_[leaf_of_[slot / kLanes]].place;
  while (nodes_[place.node].min_apex[place.lane] > apex) {
    nodes_[place.node].min_apex[place.lane] = apex;
    if (place.node == 0) break;
    place = parents_[place.node];
  }
}

}  // namespace meshfront
