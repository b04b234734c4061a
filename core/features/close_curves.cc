// 1. a tree over the boxes around the edges' middles; 2. each face is looked up in it; 3. where it is near enough, a walk there; 4. where
// that does not arrive, a search over the faces around.
#include "core/features/close_curves.h"

#include <algorithm>
#include <array>

#include "absl/container/flat_hash_set.h"
#include "core/base/status_macros.h"
#include "core/features/tolerances.h"
#include "core/geometry/bvh.h"
#include "core/geometry/triangle.h"

namespace meshfront {
namespace {

using FaceSet = absl::flat_hash_set<uint32_t>;

struct LoopEdge {
  const SourcePoint* from;
  Vec3 middle;
  double reach;
  FaceSet around;  // filled when a walk did not arrive
};

std::array<Vec3, 3> CornersOf(const MeshSurface& surface, uint32_t face) {
  const Triangle& t = surface.mesh().triangles[face];
  return {surface.mesh().PositionAt(t[0]), surface.mesh().PositionAt(t[1]), surface.mesh().PositionAt(t[2])};
}

Vec3 ClosestOn(const std::array<Vec3, 3>& corners, const Vec3& place) {
  return ClosestPointOnTriangle(place, corners[0], corners[1], corners[2]).position;
}

// The faces within a few lengths of the edge that lead there from its start. What a walk does not reach may lie behind a notch.
FaceSet FacesAround(const MeshSurface& surface, const LoopEdge& edge) {
  FaceSet faces = {edge.from->patch};
  std::vector<uint32_t> queue = {edge.from->patch};
  for (size_t i = 0; i < queue.size() && faces.size() < kMaxFacesAroundCurve; ++i) {
    if (Distance(ClosestOn(CornersOf(surface, queue[i]), edge.middle), edge.middle) > kAroundCurve * edge.reach)
      continue;
    for (const uint32_t across : surface.adjacency().opposite[queue[i]]) {
      if (across != kNoHalfEdge && faces.insert(across / 3).second) queue.push_back(across / 3);
    }
  }
  return faces;
}

class CloseCurveSearch {
 public:
  CloseCurveSearch(const MeshSurface& surface, const std::vector<OrientedLoop>& loops) : surface_(surface) {
    for (const OrientedLoop& loop : loops) {
      for (size_t i = 0; i < loop.points.size(); ++i) Add(loop.points[i], loop.points[(i + 1) % loop.points.size()]);
    }
  }

  absl::StatusOr<bool> Run(const Context& context) {
    const TriangleBvh tree(corners_, boxes_);
    bool is_close = false;
    for (uint32_t f = 0; f < surface_.mesh().triangles.size() && !is_close; ++f) {
      if (f % kFacesBetweenChecks == 0) MESHFRONT_RETURN_IF_ERROR(context.CheckStop());
      const std::array<Vec3, 3> corners = CornersOf(surface_, f);
      Box3 box;
      for (const Vec3& p : corners) box.Extend(p);
      tree.VisitOverlaps(box, [&](FaceId i) {
        is_close = IsClose(edges_[i.index()], f, corners);
        return !is_close;
      });
    }
    return is_close;
  }

 private:
  void Add(const SourcePoint& a, const SourcePoint& b) {
    const Vec3 middle = 0.5 * (a.position + b.position);
    const double reach = kCloseToCurve * Distance(a.position, b.position);
    const auto first = static_cast<uint32_t>(corners_.size());
    corners_.push_back(middle - Vec3{reach, reach, reach});
    corners_.push_back(middle + Vec3{reach, reach, reach});
    boxes_.push_back({VertexId(first), VertexId(first + 1), VertexId(first + 1)});
    edges_.push_back({&a, middle, reach, {}});
  }
  bool IsClose(LoopEdge& edge, uint32_t face, const std::array<Vec3, 3>& corners) {
    const Vec3 place = ClosestOn(corners, edge.middle);
    if (Distance(place, edge.middle) > edge.reach) return false;
    if (Distance(surface_.Snap(*edge.from, place).position, place) <= kReached * edge.reach) return false;
    if (edge.around.empty()) {
      if (faces_looked_at_ > kMaxFacesAroundCurves) return true;
      edge.around = FacesAround(surface_, edge);
      faces_looked_at_ += edge.around.size();
    }
    return !edge.around.contains(face);
  }

  const MeshSurface& surface_;
  std::vector<LoopEdge> edges_;
  std::vector<Vec3> corners_;  // of the boxes around the edges' middles
  std::vector<Triangle> boxes_;
  size_t faces_looked_at_ = 0;
};

}  // namespace

absl::StatusOr<bool> DoCurvesLieClose(const MeshSurface& surface, const std::vector<OrientedLoop>& loops,
                                      const Context& context) {
  for (const OrientedLoop& loop : loops) {
    if (std::any_of(loop.creases.begin(), loop.creases.end(), [](bool on_crease) { return on_crease; })) return true;
  }
  if (loops.empty()) return false;
  return CloseCurveSearch(surface, loops).Run(context);
}

}  // namespace meshfront
