// 1. MarkInner   faces that touch no other ones
// 2. Clip        each segment in steps: where it goes from on to off the inner faces, the place is bisected
#include "core/features/line_clipping.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "core/features/tolerances.h"
#include "core/geometry/bvh.h"

namespace meshfront {
namespace {

class Clipper {
 public:
  Clipper(const Polylines& lines, const TriangleMesh& mesh, const std::vector<bool>& chosen, double diagonal)
      : lines_(lines), mesh_(mesh), tree_(mesh.positions, mesh.triangles), reach_(kLineReach * diagonal) {
    MarkInner(chosen);
  }

  ClippedLines Run() {
    clipped_.lines.points = lines_.points;
    for (uint32_t i = 0; i < lines_.segments.size(); ++i) Clip(i);
    return std::move(clipped_);
  }

 private:
  void MarkInner(const std::vector<bool>& chosen) {
    std::vector<bool> is_shared(mesh_.positions.size());
    for (size_t f = 0; f < chosen.size(); ++f) {
      for (const VertexId v : mesh_.triangles[f]) is_shared[v.index()] = is_shared[v.index()] || !chosen[f];
    }
    double sum = 0;
    size_t count = 0;
    inner_.resize(chosen.size());
    for (size_t f = 0; f < chosen.size(); ++f) {
      const Triangle& t = mesh_.triangles[f];
      inner_[f] = std::none_of(t.begin(), t.end(), [&](VertexId v) { return is_shared[v.index()]; });
      if (inner_[f]) sum += Distance(mesh_.PositionAt(t[0]), mesh_.PositionAt(t[1])), ++count;
    }
    step_ = count > 0 ? kClipStepPerEdge * sum / static_cast<double>(count) : 0;
  }

  bool IsOn(const Vec3& p) const {
    const std::optional<ClosestHit> hit = tree_.FindClosestPoint(p, reach_);
    return hit && inner_[hit->face.index()];
  }

  // Between one share of the way where the line is on, and one where it is not: the last place where it is.
  double Bisect(const Vec3& a, const Vec3& b, double on, double off) const {
    for (int i = 0; i < kClipHalvings; ++i) {
      const double middle = 0.5 * (on + off);
      (IsOn((1 - middle) * a + middle * b) ? on : off) = middle;
    }
    return on;
  }

  void Clip(uint32_t segment) {
    const auto [from, to] = lines_.segments[segment];
    const Vec3 &a = lines_.points[from], &b = lines_.points[to];
    const double steps = step_ > 0 ? std::ceil(Distance(a, b) / step_) : 1;
    const int count = static_cast<int>(std::clamp<double>(steps, 1, kMostClipSteps));
    double begin = -1;  // of the part at hand; negative: there is none
    bool is_whole = true;
    for (int i = 0; i <= count; ++i) {
      const double t = static_cast<double>(i) / count;
      const bool is_on = step_ > 0 && IsOn((1 - t) * a + t * b);
      const double before = static_cast<double>(i - 1) / count;
      if (is_on && begin < 0) begin = i == 0 ? 0 : Bisect(a, b, t, before);
      if (!is_on && begin >= 0) Add(segment, std::exchange(begin, -1), Bisect(a, b, before, t));
      is_whole = is_whole && is_on;
    }
    if (begin >= 0) Add(segment, begin, 1);
    if (!is_whole) clipped_.cut.push_back(segment);
  }

  void Add(uint32_t segment, double begin, double end) {
    if (!(begin < end)) return;
    const auto [from, to] = lines_.segments[segment];
    clipped_.lines.segments.push_back({PointAt(from, to, begin), PointAt(from, to, end)});
    clipped_.origins.push_back(segment);
  }
  // Ends of segments stay shared.
  uint32_t PointAt(uint32_t from, uint32_t to, double t) {
    if (t == 0 || t == 1) return t == 0 ? from : to;
    clipped_.lines.points.push_back((1 - t) * lines_.points[from] + t * lines_.points[to]);
    return static_cast<uint32_t>(clipped_.lines.points.size() - 1);
  }

  const Polylines& lines_;
  const TriangleMesh& mesh_;
  const TriangleBvh tree_;
  const double reach_;
  std::vector<bool> inner_;
  double step_ = 0;
  ClippedLines clipped_;
};

}  // namespace

ClippedLines ClipPolylines(const Polylines& lines, const TriangleMesh& mesh, const std::vector<bool>& chosen,
                           double diagonal) {
  return Clipper(lines, mesh, chosen, diagonal).Run();
}

}  // namespace meshfront
