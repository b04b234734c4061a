// A kd-tree of points: nearest ones, with or without a condition, and those within reach of a box.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "absl/types/span.h"
#include "core/geometry/box.h"
#include "core/geometry/vec3.h"

namespace meshfront {

// Immutable after construction; safe to read from many threads; deterministic, of equal distances the lower index wins.
// The tree's order puts points that are near each other next to each other; all indices are those of the points as they
// were given. O(n log n); 28 bytes a point and 72 a node of up to 8 points.
class PointTree {
 public:
  static constexpr uint32_t kNone = 0xffffffffu;
  struct Node {
    Box3 box;
    uint32_t begin, end;  // in `order`
    uint32_t right;       // of two children the second, the first comes next; 0: a leaf
    bool is_leaf() const { return right == 0; }
  };

  // `points` outlives the tree.
  explicit PointTree(absl::Span<const Vec3> points);

  absl::Span<const uint32_t> order() const { return order_; }
  absl::Span<const Node> nodes() const { return nodes_; }  // the root first; none when there are no points

  // The nearest up to `count` points, the nearest first (squared distance, index). About 1 µs for 12.
  void FindNearest(const Vec3& x, size_t count, std::vector<std::pair<double, uint32_t>>& found) const;
  // The nearest point that `accept(index)` is true of, closer than the root of `limit`; kNone when there is none.
  template <typename Accept>
  uint32_t FindNearest(const Vec3& x, double limit, const Accept& accept) const {
    return FindNearest(x, limit, accept, [](uint32_t) { return true; });
  }
  // The same where a whole node is passed over unless `may_hold(node)`, which must be true where `accept` is of one of its points.
  template <typename Accept, typename MayHold>
  uint32_t FindNearest(const Vec3& x, double limit, const Accept& accept, const MayHold& may_hold) const;
  // Calls visit(index) for the points of all leaves whose boxes come within reach(node) of a box.
  template <typename Reach, typename Visit>
  void VisitNear(const Box3& box, const Reach& reach, const Visit& visit) const;

 private:
  static constexpr uint32_t kLeafPoints = 8;
  static constexpr size_t kMaxDepth = 64;
  void Build(uint32_t begin, uint32_t end);

  absl::Span<const Vec3> points_;
  std::vector<uint32_t> order_;
  std::vector<Node> nodes_;
};

// Squared distance between two boxes; 0 where they meet.
inline double SquaredDistanceBetween(const Box3& a, const Box3& b) {
  return SquaredNorm(Max(Max(a.min - b.max, b.min - a.max), Vec3{}));
}

template <typename Accept, typename MayHold>
uint32_t PointTree::FindNearest(const Vec3& x, double limit, const Accept& accept, const MayHold& may_hold) const {
  struct Entry {
    double distance;
    uint32_t node;
  };
  std::array<Entry, kMaxDepth + 1> stack;
  size_t size = 0;
  uint32_t best = kNone;
  double least = limit;
  if (!nodes_.empty()) stack[size++] = {nodes_[0].box.SquaredDistanceTo(x), 0};
  while (size > 0) {
    const Entry at = stack[--size];
    if (at.distance > least || !may_hold(at.node)) continue;
    const Node& node = nodes_[at.node];
    if (node.is_leaf()) {
      for (uint32_t i = node.begin; i < node.end; ++i) {
        const double d = SquaredDistance(points_[order_[i]], x);
        if ((d < least || (d == least && best != kNone && order_[i] < best)) && accept(order_[i]))
          least = d, best = order_[i];
      }
      continue;
    }
    Entry near{nodes_[at.node + 1].box.SquaredDistanceTo(x), at.node + 1};
    Entry far{nodes_[node.right].box.SquaredDistanceTo(x), node.right};
    if (far.distance < near.distance) std::swap(near, far);
    if (far.distance <= least) stack[size++] = far;
    if (near.distance <= least) stack[size++] = near;
  }
  return best;
}

template <typename Reach, typename Visit>
void PointTree::VisitNear(const Box3& box, const Reach& reach, const Visit& visit) const {
  std::array<uint32_t, kMaxDepth + 1> stack;
  size_t size = 0;
  if (!nodes_.empty()) stack[size++] = 0;
  while (size > 0) {
    const uint32_t at = stack[--size];
    const Node& node = nodes_[at];
    const double r = reach(at);
    if (SquaredDistanceBetween(node.box, box) > r * r) continue;
    if (node.is_leaf()) {
      for (uint32_t i = node.begin; i < node.end; ++i) visit(order_[i]);
      continue;
    }
    stack[size++] = node.right;
    stack[size++] = at + 1;
  }
}

}  // namespace meshfront
