#include "core/surface/self_meetings.h"

#include <algorithm>

#include "absl/container/flat_hash_set.h"
#include "core/base/context.h"
#include "core/geometry/intersection.h"
#include "core/geometry/segment.h"
#include "core/geometry/triangle.h"
#include "core/mesh/self_intersection.h"
#include "core/surface/tolerances.h"

namespace meshfront {
namespace {

bool IsWithin(const Vec3& place, double radius, const std::array<Vec3, 3>& triangle) {
  const TrianglePoint closest = ClosestPointOnTriangle(place, triangle[0], triangle[1], triangle[2]);
  return SquaredDistance(closest.position, place) <= radius * radius;
}

}  // namespace

SelfMeetings::SelfMeetings(const TriangleMesh& mesh, absl::Span<const std::array<Vec3, 2>> rims,
                           const Context& context) {
  AddMeetings(mesh, context);
  AddSeams(rims);
  for (const Meeting& m : meetings_) {
    const auto first = static_cast<uint32_t>(positions_.size());
    if (m.stretch)
      positions_.insert(positions_.end(), {(*m.stretch)[0], (*m.stretch)[1], (*m.stretch)[1]});
    else
      positions_.insert(positions_.end(), m.a.begin(), m.a.end());
    triangles_.push_back({VertexId(first), VertexId(first + 1), VertexId(first + 2)});
  }
  if (!triangles_.empty()) tree_ = std::make_unique<TriangleBvh>(positions_, triangles_);
}

void SelfMeetings::AddMeetings(const TriangleMesh& mesh, const Context& context) {
  const auto found = FindSelfIntersections(mesh, surface_tolerances::kMaxSelfMeetings, context);
  if (!found.ok()) return;  // stopped: no index of a surface is out of range
  is_complete_ = found->pairs <= found->first_pairs.size();
  for (const auto& [f, g] : found->first_pairs) {
    const auto corner = [&](FaceId face, int i) { return mesh.PositionAt(mesh.triangles[face.index()][i]); };
    const Vec3 a[3] = {corner(f, 0), corner(f, 1), corner(f, 2)}, b[3] = {corner(g, 0), corner(g, 1), corner(g, 2)};
    meetings_.push_back({{a[0], a[1], a[2]}, {b[0], b[1], b[2]}, CommonStretch(a, b), false});
  }
}

void SelfMeetings::AddSeams(absl::Span<const std::array<Vec3, 2>> rims) {
  absl::flat_hash_set<std::array<double, 6>> seen;
  for (const auto& [from, to] : rims) {
    const std::array<double, 3> p = {from.x, from.y, from.z}, q = {to.x, to.y, to.z};
    const auto& [low, high] = std::minmax(p, q);
    if (seen.insert({low[0], low[1], low[2], high[0], high[1], high[2]}).second) continue;
    meetings_.push_back({{}, {}, std::array{from, to}, true});
  }
}

bool SelfMeetings::IsAnyWithin(const Vec3& place, double radius) const { return IsAnyWithin(place, radius, true); }

bool SelfMeetings::DoFacesMeetWithin(const Vec3& place, double radius) const {
  return IsAnyWithin(place, radius, false);
}

bool SelfMeetings::IsAnyWithin(const Vec3& place, double radius, bool counts_seams) const {
  if (!is_complete_) return true;
  if (tree_ == nullptr) return false;
  bool is_any = false;
  const Vec3 reach{radius, radius, radius};
  tree_->VisitOverlaps({place - reach, place + reach}, [&](FaceId i) {
    const Meeting& m = meetings_[i.index()];
    if (m.is_seam && !counts_seams) return true;
    is_any = m.stretch ? DistanceToSegment(place, (*m.stretch)[0], (*m.stretch)[1]) <= radius
                       : IsWithin(place, radius, m.a) && IsWithin(place, radius, m.b);
    return !is_any;
  });
  return is_any;
}

}  // namespace meshfront
