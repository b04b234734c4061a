// 1. a tree over the boxes around the edges' middles; 2. each face is looked up in it; 3. where it is near enough, a walk there; 4. where
// that does not arrive, a search over the faces around.
#include "core/features/close_curves.h"

#include <algorithm>

#include "absl/container/flat_hash_set.h"
#include "core/features/tolerances.h"
#include "core/geometry/bvh.h"
#include "core/geometry/triangle.h"

namespace meshfront {
namespace {

struct LoopEdge {
  const SourcePoint* from;
  Vec3 middle;
  double reach;
};

// Whether the faces around the edge, up to a few lengths away, lead to a face. What a walk does not reach may lie behind a notch.
bool IsJoined(const MeshSurface& surface, const LoopEdge& edge, FaceId wanted) {
  const double around = kAroundCurve * edge.reach;
  std::vector<uint32_t> queue = {edge.from->patch};
  absl::flat_hash_set<uint32_t> seen = {edge.from->patch};
  for (size_t i = 0; i < queue.size() && seen.size() < kMaxFacesAroundCurve; ++i) {
    const Triangle& t = surface.mesh().triangles[queue[i]];
    const Vec3 &a = surface.mesh().PositionAt(t[0]), &b = surface.mesh().PositionAt(t[1]),
               &c = surface.mesh().PositionAt(t[2]);
    if (Distance(ClosestPointOnTriangle(edge.middle, a, b, c).position, edge.middle) > around) continue;
    if (queue[i] == wanted.index()) return true;
    for (const uint32_t across : surface.adjacency().opposite[queue[i]]) {
      if (across != kNoHalfEdge && seen.insert(across / 3).second) queue.push_back(across / 3);
    }
  }
  return false;
}

}  // namespace

bool DoCurvesLieClose(const MeshSurface& surface, const std::vector<OrientedLoop>& loops) {
  std::vector<LoopEdge> edges;
  std::vector<Vec3> corners;
  std::vector<Triangle> boxes;
  for (const OrientedLoop& loop : loops) {
    if (std::any_of(loop.creases.begin(), loop.creases.end(), [](bool on_crease) { return on_crease; })) return true;
    for (size_t i = 0; i < loop.points.size(); ++i) {
      const SourcePoint &a = loop.points[i], &b = loop.points[(i + 1) % loop.points.size()];
      const Vec3 middle = 0.5 * (a.position + b.position);
      const double reach = kCloseToCurve * Distance(a.position, b.position);
      const auto first = static_cast<uint32_t>(corners.size());
      corners.push_back(middle - Vec3{reach, reach, reach});
      corners.push_back(middle + Vec3{reach, reach, reach});
      boxes.push_back({VertexId(first), VertexId(first + 1), VertexId(first + 1)});
      edges.push_back({&a, middle, reach});
    }
  }
  if (edges.empty()) return false;
  const TriangleBvh tree(corners, boxes);
  bool is_close = false;
  for (uint32_t f = 0; f < surface.mesh().triangles.size() && !is_close; ++f) {
    const Triangle& t = surface.mesh().triangles[f];
    const Vec3 &a = surface.mesh().PositionAt(t[0]), &b = surface.mesh().PositionAt(t[1]),
               &c = surface.mesh().PositionAt(t[2]);
    Box3 box;
    for (const Vec3& p : {a, b, c}) box.Extend(p);
    tree.VisitOverlaps(box, [&](FaceId i) {
      const LoopEdge& edge = edges[i.index()];
      const Vec3 place = ClosestPointOnTriangle(edge.middle, a, b, c).position;
      if (Distance(place, edge.middle) > edge.reach) return true;
      const Vec3 reached = surface.Snap(*edge.from, place).position;
      is_close = Distance(reached, place) > kReached * edge.reach && !IsJoined(surface, edge, FaceId(f));
      return !is_close;
    });
  }
  return is_close;
}

}  // namespace meshfront
