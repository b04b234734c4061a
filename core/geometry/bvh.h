// A static bounding volume hierarchy over triangles: closest points, first hits of segments, overlaps with boxes.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "absl/types/span.h"
#include "core/base/ids.h"
#include "core/geometry/box.h"
#include "core/geometry/triangle.h"
#include "core/geometry/vec3.h"

namespace meshfront {

// Where the closest point or the first hit lies. `point.weights` belong to the face's corners.
struct ClosestHit {
  FaceId face;
  TrianglePoint point;
  double squared_distance = 0;
};
struct SegmentHit {
  FaceId face;
  double t = 0;  // origin + t direction
  double weights[3] = {};
};

// Refers to the arrays it was built from: they must outlive it unchanged, with finite coordinates below 1e150 and
// indices in range. Immutable, thread-safe, 13 + 4 bytes a triangle at the usual filling. Built in O(n), about 0.1 µs a
// triangle. Results are functions of the triangles alone, whatever the order of traversal: ties go to the smaller face.
//
//   const TriangleBvh bvh(mesh.positions, mesh.triangles);
//   if (auto hit = bvh.FindClosestPoint(p, bound)) Use(hit->face, hit->point.position);
class TriangleBvh {
 public:
  using Corners = std::array<VertexId, 3>;

  TriangleBvh(absl::Span<const Vec3> positions, absl::Span<const Corners> triangles);

  // The closest point of the triangles at most `max_distance` away. O(log n) near the surface; far from it, where many
  // triangles are almost equally close, more.
  std::optional<ClosestHit> FindClosestPoint(const Vec3& p,
                                             double max_distance = std::numeric_limits<double>::infinity()) const {
    return FindClosestPoint(p, max_distance, [](FaceId) { return true; });
  }
  // The same among the faces that accept(FaceId) admits.
  template <class Accept>
  std::optional<ClosestHit> FindClosestPoint(const Vec3& p, double max_distance, Accept&& accept) const;

  // The hit with the smallest t in [t0, t1] on origin + t direction, from either side. Rays through a shared edge or
  // vertex do not slip through; a ray in the plane of a triangle does not hit it.
  std::optional<SegmentHit> FindFirstHit(const Vec3& origin, const Vec3& direction, double t0, double t1) const {
    return FindFirstHit(origin, direction, t0, t1, [](FaceId) { return true; });
  }
  template <class Accept>
  std::optional<SegmentHit> FindFirstHit(const Vec3& origin, const Vec3& direction, double t0, double t1,
                                         Accept&& accept) const;

  // Calls visit(FaceId) for each triangle whose bounding box meets `box` (touching counts), until visit returns false.
  template <class Visit>
  void VisitOverlaps(const Box3& box, Visit&& visit) const;
  // Calls visit(FaceId, FaceId) once for each pair of triangles whose bounding boxes meet. O(n) for surfaces.
  template <class Visit>
  void VisitOverlappingPairs(Visit&& visit) const;
  // The faces in the order in which VisitOverlaps comes by them.
  absl::Span<const uint32_t> order() const { return order_; }

  const Box3& bounds() const { return bounds_; }
  Box3 BoxOf(FaceId f) const;

 private:
  // Boxes are kept in a frame where the root is [-1, 1]³, in floats rounded outwards. Siblings are neighbours and share
  // a cache line: children of node n are nodes_[first] and nodes_[first + 1].
  struct Node {
    float min[3], max[3];
    uint32_t first;  // leaf: into order_
    uint32_t count;  // triangles of a leaf; 0 for an inner node
  };
  static_assert(sizeof(Node) == 32);
  static constexpr uint32_t kLeafSize = 4;  // triangles at most
  static constexpr int kStack = 192;        // deeper than any tree: 48 bits of code, then halving, one entry a level
  struct Ray {
    Vec3 origin, inverse;  // in the frame of the boxes
    double t0, t1;
  };

  void Build(uint32_t node, uint32_t begin, uint32_t end, absl::Span<const uint64_t> codes);
  void SetBox(uint32_t node, const Box3& box);
  Vec3 ToFrame(const Vec3& p) const { return scale_ * (p - center_); }
  static double SquaredDistance(const Node& node, const Vec3& q);
  static bool Meet(const Node& a, const Node& b);
  static bool IsHit(const Node& node, const Ray& ray, double* entry);
  Ray RayInFrame(const Vec3& origin, const Vec3& direction, double t0, double t1) const;
  std::optional<SegmentHit> HitFace(FaceId f, const Vec3& origin, const Vec3& direction) const;
  const Vec3& Corner(FaceId f, int i) const { return positions_[triangles_[f.index()][i].index()]; }

  absl::Span<const Vec3> positions_;
  absl::Span<const Corners> triangles_;
  std::vector<Node> nodes_;
  std::vector<uint32_t> order_;  // faces, leaf by leaf
  Box3 bounds_;
  Vec3 center_;
  double scale_ = 1;
};

// --- Implementation of the templates ---------------------------------------------------------------------------------

inline double TriangleBvh::SquaredDistance(const Node& node, const Vec3& q) {
  double sum = 0;
  for (int i = 0; i < 3; ++i) {
    const double d = std::max(std::max(node.min[i] - q[i], q[i] - node.max[i]), 0.0);
    sum += d * d;
  }
  return sum;
}

template <class Accept>
std::optional<ClosestHit> TriangleBvh::FindClosestPoint(const Vec3& p, double max_distance, Accept&& accept) const {
  if (nodes_.empty() || !(max_distance >= 0)) return std::nullopt;
  ClosestHit best;
  best.squared_distance = max_distance * max_distance;
  const Vec3 q = ToFrame(p);
  // Bounds are compared in the frame of the boxes, a few ulp to the generous side.
  const double to_frame = scale_ * scale_ * (1 + 1e-14);
  std::pair<uint32_t, double> stack[kStack];
  int depth = 0;
  stack[depth++] = {0, SquaredDistance(nodes_[0], q)};
  while (depth > 0) {
    const auto [index, lower_bound] = stack[--depth];
    if (lower_bound > best.squared_distance * to_frame) continue;
    const Node& node = nodes_[index];
    for (uint32_t i = node.first; i < node.first + node.count; ++i) {
      const FaceId f(order_[i]);
      if (!accept(f)) continue;
      const TrianglePoint at = ClosestPointOnTriangle(p, Corner(f, 0), Corner(f, 1), Corner(f, 2));
      const double d2 = meshfront::SquaredDistance(p, at.position);
      // FaceId{} is the largest id, so the first hit at the bound itself is taken too.
      if (d2 < best.squared_distance || (d2 == best.squared_distance && f < best.face)) best = {f, at, d2};
    }
    if (node.count > 0) continue;
    std::pair<uint32_t, double> near{node.first, SquaredDistance(nodes_[node.first], q)};
    std::pair<uint32_t, double> far{node.first + 1, SquaredDistance(nodes_[node.first + 1], q)};
    if (far.second < near.second) std::swap(near, far);
    const double bound = best.squared_distance * to_frame;
    if (far.second <= bound) stack[depth++] = far;
    if (near.second <= bound) stack[depth++] = near;
  }
  if (!best.face.valid()) return std::nullopt;
  return best;
}

// Slabs. Rounding is covered by a relative margin on the far end.
inline bool TriangleBvh::IsHit(const Node& node, const Ray& ray, double* entry) {
  double t0 = ray.t0, t1 = ray.t1;
  for (int i = 0; i < 3; ++i) {
    const double a = (node.min[i] - ray.origin[i]) * ray.inverse[i];
    const double b = (node.max[i] - ray.origin[i]) * ray.inverse[i];
    t0 = std::max(t0, std::min(a, b));
    t1 = std::min(t1, std::max(a, b));
  }
  *entry = t0;
  return t0 <= t1 + 1e-14 * std::abs(t1);
}

template <class Accept>
std::optional<SegmentHit> TriangleBvh::FindFirstHit(const Vec3& origin, const Vec3& direction, double t0, double t1,
                                                    Accept&& accept) const {
  if (nodes_.empty()) return std::nullopt;
  Ray ray = RayInFrame(origin, direction, t0, t1);
  SegmentHit best;
  best.t = t1;
  uint32_t stack[kStack];
  int depth = 0;
  double entry, other_entry;
  if (IsHit(nodes_[0], ray, &entry)) stack[depth++] = 0;
  while (depth > 0) {
    const Node& node = nodes_[stack[--depth]];
    if (!IsHit(node, ray, &entry)) continue;  // a nearer hit may have been found since
    for (uint32_t i = node.first; i < node.first + node.count; ++i) {
      const FaceId f(order_[i]);
      const std::optional<SegmentHit> hit = accept(f) ? HitFace(f, origin, direction) : std::nullopt;
      if (!hit || !(hit->t >= t0)) continue;
      if (hit->t < best.t || (hit->t == best.t && f < best.face)) best = *hit, ray.t1 = hit->t;
    }
    if (node.count > 0) continue;
    const bool left = IsHit(nodes_[node.first], ray, &entry), right = IsHit(nodes_[node.first + 1], ray, &other_entry);
    const bool right_is_nearer = right && (!left || other_entry < entry);
    if (right && !right_is_nearer) stack[depth++] = node.first + 1;
    if (left) stack[depth++] = node.first;
    if (right && right_is_nearer) stack[depth++] = node.first + 1;
  }
  if (!best.face.valid()) return std::nullopt;
  return best;
}

template <class Visit>
void TriangleBvh::VisitOverlaps(const Box3& box, Visit&& visit) const {
  if (nodes_.empty() || box.empty()) return;
  const Vec3 low = ToFrame(box.min), high = ToFrame(box.max);
  uint32_t stack[kStack];
  int depth = 0;
  stack[depth++] = 0;
  while (depth > 0) {
    const Node& node = nodes_[stack[--depth]];
    bool apart = false;
    for (int i = 0; i < 3; ++i) apart |= high[i] < node.min[i] || low[i] > node.max[i];
    if (apart) continue;
    for (uint32_t i = node.first; i < node.first + node.count; ++i) {
      const FaceId f(order_[i]);
      const Box3 own = BoxOf(f);
      bool meets = true;
      for (int axis = 0; axis < 3; ++axis) meets &= own.min[axis] <= box.max[axis] && own.max[axis] >= box.min[axis];
      if (meets && !visit(f)) return;
    }
    if (node.count == 0) stack[depth++] = node.first + 1, stack[depth++] = node.first;
  }
}

inline bool TriangleBvh::Meet(const Node& a, const Node& b) {
  bool apart = false;  // without branches, as below: either answer is as likely
  for (int i = 0; i < 3; ++i) apart |= (a.max[i] < b.min[i]) | (b.max[i] < a.min[i]);
  return !apart;
}

// Both trees, the same twice, are gone down together.
template <class Visit>
void TriangleBvh::VisitOverlappingPairs(Visit&& visit) const {
  if (nodes_.empty()) return;
  std::vector<Box3> boxes;  // in the order of order_
  boxes.reserve(order_.size());
  for (const uint32_t f : order_) boxes.push_back(BoxOf(FaceId(f)));
  const auto meet = [](const Box3& a, const Box3& b) {
    return (a.min.x <= b.max.x) & (b.min.x <= a.max.x) & (a.min.y <= b.max.y) & (b.min.y <= a.max.y) &
           (a.min.z <= b.max.z) & (b.min.z <= a.max.z);
  };
  const auto visit_leaves = [&](const Node& a, const Node& b) {
    std::pair<uint32_t, uint32_t> meeting[kLeafSize * kLeafSize];
    int count = 0;
    for (uint32_t i = a.first; i < a.first + a.count; ++i) {
      for (uint32_t j = &a == &b ? i + 1 : b.first; j < b.first + b.count; ++j) {
        meeting[count] = {i, j};
        count += meet(boxes[i], boxes[j]);
      }
    }
    for (int k = 0; k < count; ++k) visit(FaceId(order_[meeting[k].first]), FaceId(order_[meeting[k].second]));
  };
  std::vector<std::pair<uint32_t, uint32_t>> stack = {{0, 0}};
  const auto push = [&](uint32_t a, uint32_t b) {
    if (a == b || Meet(nodes_[a], nodes_[b])) stack.push_back({a, b});
  };
  while (!stack.empty()) {
    const auto [a, b] = stack.back();
    stack.pop_back();
    const Node &at_a = nodes_[a], &at_b = nodes_[b];
    if (at_a.count > 0 && at_b.count > 0) {
      visit_leaves(at_a, at_b);
    } else if (a == b) {
      push(at_a.first, at_a.first), push(at_a.first + 1, at_a.first + 1), push(at_a.first, at_a.first + 1);
    } else if (at_a.count > 0) {
      push(a, at_b.first), push(a, at_b.first + 1);
    } else if (at_b.count > 0) {
      push(at_a.first, b), push(at_a.first + 1, b);
    } else {
      for (const uint32_t child : {at_a.first, at_a.first + 1}) push(child, at_b.first), push(child, at_b.first + 1);
    }
  }
}

}  // namespace meshfront
