#include "core/front/audit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "absl/container/flat_hash_map.h"
#include "absl/types/span.h"
#include "core/front/meeting_boxes.h"
#include "core/geometry/intersection.h"

namespace meshfront {
namespace {

// The triangles of pairs (i, j), by i, and for each i by the rank of j.
WindowTrianglePairs InOrder(const std::vector<std::pair<uint32_t, uint32_t>>& pairs, absl::Span<const uint32_t> ranked,
                            const std::vector<WindowTriangleId>& ids) {
  if (pairs.empty()) return {};
  std::vector<uint32_t> rank(ranked.size());
  for (uint32_t i = 0; i < ranked.size(); ++i) rank[ranked[i]] = i;
  std::vector<std::pair<uint32_t, uint32_t>> keys;
  for (const auto& [i, j] : pairs) keys.push_back({i, rank[j]});
  std::sort(keys.begin(), keys.end());
  WindowTrianglePairs sorted;
  for (const auto& [i, rank_of_j] : keys) sorted.push_back({ids[i], ids[ranked[rank_of_j]]});
  return sorted;
}

// Whether the triangles around a vertex go round it once and all face its normal's way: seen along the normal they lie side by side,
// so that no two of them meet in more than they share.
bool HasSimpleStar(const FrontSet& fronts, WindowVertexId id) {
  const WindowVertex& v = fronts.at(id);
  const Vec3 n = v.source.normal;
  const Vec3 across = std::abs(n.x) < 0.6 ? Vec3{0, -n.z, n.y} : Vec3{n.z, 0, -n.x};  // any direction in the plane of n
  bool faces = true;
  int rounds = 0;  // a spoke from below the axis to above it: with every turn below 180° once a round
  const bool closed = fronts.VisitFan(id, [&](WindowTriangleId t, int corner) {
    const WindowTriangle& triangle = fronts.at(t);
    const Vec3 from = fronts.at(triangle.corners[(corner + 1) % 3]).position - v.position;
    const Vec3 to = fronts.at(triangle.corners[(corner + 2) % 3]).position - v.position;
    faces = faces && Dot(Cross(from, to), n) > 0;
    rounds += Dot(from, across) < 0 && !(Dot(to, across) < 0);
  });
  return closed && faces && rounds == 1;
}

}  // namespace

WindowTrianglePairs FindIntersections(const FrontSet& fronts, absl::FunctionRef<bool(WindowTriangleId)> leaves) {
  std::vector<Vec3> positions(fronts.vertex_slots());
  for (uint32_t i = 0; i < positions.size(); ++i) positions[i] = fronts.at(WindowVertexId(i)).position;
  // Window vertices of one joint are one vertex here: the first of them. So are those of rims that touch, which are joined by their
  // places alone.
  absl::flat_hash_map<std::array<double, 3>, uint32_t> first_at;
  const auto name_of = [&](WindowVertexId v) {
    const WindowVertex& vertex = fronts.at(v);
    if (!vertex.on_rim) return VertexId(v.index());
    const Vec3& p = vertex.position;
    return VertexId(first_at.try_emplace({p.x, p.y, p.z}, v.index()).first->second);
  };
  std::vector<Triangle> triangles;
  std::vector<WindowTriangleId> ids;
  for (uint32_t i = 0; i < fronts.triangle_slots(); ++i) {
    const WindowTriangle& t = fronts.at(WindowTriangleId(i));
    if (!t.alive) continue;
    triangles.push_back({name_of(t.corners[0]), name_of(t.corners[1]), name_of(t.corners[2])});
    ids.push_back(WindowTriangleId(i));
  }
  const auto place = [&](const Triangle& t, int i) { return positions[t[i].index()]; };
  std::vector<uint8_t> is_simple(positions.size());
  for (uint32_t i = 0; i < is_simple.size(); ++i) {
    const WindowVertex& v = fronts.at(WindowVertexId(i));
    is_simple[i] = v.alive && !v.on_front() && HasSimpleStar(fronts, WindowVertexId(i));
  }
  std::vector<uint8_t> is_leaving(triangles.size());
  for (uint32_t i = 0; i < triangles.size(); ++i) is_leaving[i] = leaves(ids[i]);
  const MeetingBoxes meeting = FindMeetingBoxes(positions, triangles, is_leaving, is_simple);
  std::vector<std::pair<uint32_t, uint32_t>> found;
  for (auto [i, j] : meeting.pairs) {
    if (is_leaving[i] == is_leaving[j] ? j < i : is_leaving[j]) std::swap(i, j);  // i leaves, the elder if both do
    const Vec3 a[3] = {place(triangles[i], 0), place(triangles[i], 1), place(triangles[i], 2)};
    const Vec3 b[3] = {place(triangles[j], 0), place(triangles[j], 1), place(triangles[j], 2)};
    if (TrianglesIntersect(a, b, SharedCornersOf(triangles[i], triangles[j]))) found.push_back({i, j});
  }
  return InOrder(found, meeting.order, ids);
}

}  // namespace meshfront
