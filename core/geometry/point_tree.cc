// Nodes halve their points at the median of the longest side of their box, and are stored before their children: depth
// is the logarithm of the number of points however they lie. Rejected: nanoflann; its filters and its order of equal
// distances are its own.
#include "core/geometry/point_tree.h"

#include <algorithm>
#include <numeric>

namespace meshfront {

PointTree::PointTree(absl::Span<const Vec3> points) : points_(points), order_(points.size()) {
  std::iota(order_.begin(), order_.end(), 0u);
  if (!points.empty()) Build(0, static_cast<uint32_t>(points.size()));
}

void PointTree::Build(uint32_t begin, uint32_t end) {
  Node node{{}, begin, end, 0};
  for (uint32_t i = begin; i < end; ++i) node.box.Extend(points_[order_[i]]);
  const size_t at = nodes_.size();
  nodes_.push_back(node);
  if (end - begin <= kLeafPoints) {
    std::sort(order_.begin() + begin, order_.begin() + end);
    return;
  }
  const Vec3 extent = node.box.max - node.box.min;
  const int axis = extent.x >= extent.y && extent.x >= extent.z ? 0 : extent.y >= extent.z ? 1 : 2;
  const uint32_t middle = begin + (end - begin) / 2;
  std::nth_element(order_.begin() + begin, order_.begin() + middle, order_.begin() + end, [&](uint32_t a, uint32_t b) {
    const double x = points_[a][axis], y = points_[b][axis];
    return x != y ? x < y : a < b;
  });
  Build(begin, middle);
  nodes_[at].right = static_cast<uint32_t>(nodes_.size());
  Build(middle, end);
}

void PointTree::FindNearest(const Vec3& x, size_t count, std::vector<std::pair<double, uint32_t>>& found) const {
  found.clear();
  count = std::min(count, points_.size());
  if (count == 0) return;
  std::array<std::pair<double, uint32_t>, kMaxDepth + 1> stack;
  size_t size = 0;
  stack[size++] = {nodes_[0].box.SquaredDistanceTo(x), 0};
  while (size > 0) {
    const auto [distance, at] = stack[--size];
    if (found.size() == count && distance > found.back().first) continue;
    const Node& node = nodes_[at];
    if (!node.is_leaf()) {
      std::pair<double, uint32_t> near{nodes_[at + 1].box.SquaredDistanceTo(x), at + 1};
      std::pair<double, uint32_t> far{nodes_[node.right].box.SquaredDistanceTo(x), node.right};
      if (far.first < near.first) std::swap(near, far);
      stack[size++] = far, stack[size++] = near;
      continue;
    }
    for (uint32_t i = node.begin; i < node.end; ++i) {
      const std::pair<double, uint32_t> entry{SquaredDistance(points_[order_[i]], x), order_[i]};
      if (found.size() == count) {
        if (entry.first > found.back().first || !(entry < found.back())) continue;
        found.pop_back();
      }
      size_t place = found.size();
      found.push_back(entry);
      for (; place > 0 && entry < found[place - 1]; --place) found[place] = found[place - 1];
      found[place] = entry;
    }
  }
}

}  // namespace meshfront
