// 1. Project: the normal is Newell's sum over corners relative to the first one and scaled by the extent (so that neither 1e300
//    nor 1e-300 overflows); the two coordinates are those across the normal's largest component, in an order that keeps the
//    polygon counter-clockwise.
// 2. IsConvex: no corner turns clockwise.
// 3. CutEars: walk the ring; a corner that turns left and whose triangle holds no reflex corner is an ear. When a full round finds
//    none (the polygon cuts itself), or the tests are used up, any corner goes.
// Rejected: triangulation by monotone pieces; O(n log n), but polygons in files have a handful of corners.
#include "core/io/polygon.h"

#include <algorithm>
#include <cmath>

namespace meshfront {
namespace {

template <class P>
double Area2(const P& a, const P& b, const P& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

}  // namespace

void PolygonCutter::Append(absl::Span<const uint32_t> corners, TriangleMesh& mesh) {
  if (corners.size() > 3 && corners.size() <= kMaxEarCorners && Project(corners, mesh.positions) && !IsConvex()) {
    CutEars(corners, mesh.triangles);
    return;
  }
  for (size_t i = 2; i < corners.size(); ++i) {
    mesh.triangles.push_back({VertexId(corners[0]), VertexId(corners[i - 1]), VertexId(corners[i])});
  }
}

bool PolygonCutter::Project(absl::Span<const uint32_t> corners, const std::vector<Vec3>& positions) {
  double extent = 0;
  for (const uint32_t corner : corners) {
    if (corner >= positions.size()) return false;
    const Vec3 d = positions[corner] - positions[corners[0]];
    extent = std::max({extent, std::fabs(d.x), std::fabs(d.y), std::fabs(d.z)});
    if (!IsFinite(d)) return false;
  }
  if (!(extent > 0)) return false;
  auto local = [&](size_t i) { return (positions[corners[i % corners.size()]] - positions[corners[0]]) / extent; };
  Vec3 normal;
  for (size_t i = 0; i < corners.size(); ++i) normal += Cross(local(i), local(i + 1));
  int axis = 0;
  if (std::fabs(normal.y) > std::fabs(normal[axis])) axis = 1;
  if (std::fabs(normal.z) > std::fabs(normal[axis])) axis = 2;
  if (!(std::fabs(normal[axis]) > 0)) return false;
  const double flip = normal[axis] > 0 ? 1 : -1;
  points_.clear();
  for (size_t i = 0; i < corners.size(); ++i) {
    const Vec3 p = local(i);
    points_.push_back({flip * p[(axis + 1) % 3], p[(axis + 2) % 3]});
  }
  return true;
}

bool PolygonCutter::IsConvex() const {
  const size_t n = points_.size();
  for (size_t i = 0; i < n; ++i) {
    if (Area2(points_[i], points_[(i + 1) % n], points_[(i + 2) % n]) < 0) return false;
  }
  return true;
}

double PolygonCutter::Turn(uint32_t corner) const {
  return Area2(points_[previous_[corner]], points_[corner], points_[next_[corner]]);
}

bool PolygonCutter::IsEar(uint32_t corner) {
  if (!(Turn(corner) > 0)) return false;
  const Point a = points_[previous_[corner]], b = points_[corner], c = points_[next_[corner]];
  for (const uint32_t r : reflex_) {
    if (r == previous_[corner] || r == next_[corner] || r == corner) continue;
    --tests_left_;
    const Point p = points_[r];
    if (p == a || p == b || p == c) continue;  // a hole joined by a bridge names its corners twice
    if (Area2(a, b, p) >= 0 && Area2(b, c, p) >= 0 && Area2(c, a, p) >= 0) return false;
  }
  return true;
}

void PolygonCutter::Unlink(uint32_t corner) {
  const uint32_t before = previous_[corner], after = next_[corner];
  next_[before] = after;
  previous_[after] = before;
  // A cut can only straighten its two neighbours: those that no longer turn right leave the list of reflex corners.
  reflex_.erase(std::remove_if(reflex_.begin(), reflex_.end(),
                               [&](uint32_t r) { return r == corner || ((r == before || r == after) && Turn(r) > 0); }),
                reflex_.end());
}

void PolygonCutter::CutEars(absl::Span<const uint32_t> corners, std::vector<Triangle>& out) {
  const uint32_t n = static_cast<uint32_t>(corners.size());
  next_.resize(n), previous_.resize(n), reflex_.clear();
  for (uint32_t i = 0; i < n; ++i) next_[i] = (i + 1) % n, previous_[i] = (i + n - 1) % n;
  for (uint32_t i = 0; i < n; ++i) {
    if (!(Turn(i) > 0)) reflex_.push_back(i);
  }
  tests_left_ = 512 * int64_t{n};
  uint32_t at = 0, left = n, since_last_ear = 0;
  while (left > 3) {
    const bool forced = tests_left_ <= 0 || since_last_ear > left;
    if (!forced && !IsEar(at)) {
      at = next_[at], ++since_last_ear;
      continue;
    }
    out.push_back({VertexId(corners[previous_[at]]), VertexId(corners[at]), VertexId(corners[next_[at]])});
    if (tests_left_ > 0) tests_left_ -= static_cast<int64_t>(reflex_.size());
    if (tests_left_ <= 0) reflex_.clear();
    Unlink(at);
    at = next_[at], --left, since_last_ear = 0;
  }
  out.push_back({VertexId(corners[previous_[at]]), VertexId(corners[at]), VertexId(corners[next_[at]])});
}

}  // namespace meshfront
