// 1. Choose the vertices to probe, so that every other has one next to it, near against its limit (ChooseProbes). 2. From each
// probe a ray inwards and one outwards, first hit among the faces that look the other way (FindOpposedHit); 3. unless that face
// is reached along the surface by a short way (IsNearAlongSurface): then it is the same sheet, bent. 4. The others take the least
// of the probes next to them.
// Rejected: the closest opposed point instead of rays. It grows with every detail near by and costs four times as much.
#include "core/surface/sheet_distance.h"

#include <algorithm>
#include <cmath>

#include "core/base/status_macros.h"
#include "core/geometry/bvh.h"
#include "core/geometry/triangle.h"
#include "core/surface/face_queue.h"
#include "core/surface/tolerances.h"

namespace meshfront {
namespace {

using namespace surface_tolerances;

constexpr size_t kGrain = 512;

struct Sheets {
  FaceView mesh;
  const FaceAdjacency& adjacency;
  absl::Span<const Vec3> normals;
  const TriangleBvh& bvh;
};

std::optional<SegmentHit> FindOpposedHit(const Sheets& sheets, uint32_t v, const Vec3& direction, double limit) {
  const Vec3& normal = sheets.normals[v];
  return sheets.bvh.FindFirstHit(sheets.mesh.positions[v], direction, 0, limit, [&](FaceId face) {
    const Triangle& t = sheets.mesh.triangles[face.index()];
    if (t[0].index() == v || t[1].index() == v || t[2].index() == v) return false;
    const Vec3 area = AreaVector(sheets.mesh.Corner(face.index(), 0), sheets.mesh.Corner(face.index(), 1),
                                 sheets.mesh.Corner(face.index(), 2));
    const double along = Dot(area, normal);
    return along < 0 && along * along > kOpposed * kOpposed * SquaredNorm(area);
  });
}

bool IsNearAlongSurface(const Sheets& sheets, uint32_t v, const SegmentHit& hit, FaceQueue& queue) {
  const double longest_way = kOtherSheetDetour * hit.t;
  queue.Clear();
  queue.Add({FaceOfHalfEdge(sheets.adjacency.outgoing[v]), 0, sheets.mesh.positions[v]});
  for (size_t i = 0; i < queue.size() && i < kMaxDetourFaces; ++i) {
    const FaceQueue::Entry at = queue[i];
    if (at.face == hit.face.index()) return true;
    queue.AddAcross(sheets.mesh, at, longest_way, [](uint32_t) { return true; });
  }
  return false;
}

double SheetDistance(const Sheets& sheets, uint32_t v, double limit, FaceQueue& queue) {
  if (sheets.adjacency.outgoing[v] == kNoHalfEdge || !(limit > 0)) return INFINITY;
  double nearest = INFINITY;
  for (const double sign : {-1.0, 1.0}) {
    const auto hit = FindOpposedHit(sheets, v, sign * sheets.normals[v], std::min(limit, nearest));
    if (hit && hit->t < nearest && !IsNearAlongSurface(sheets, v, *hit, queue)) nearest = hit->t;
  }
  return nearest;
}

// Calls visit(neighbour) for the vertices around v that are near against `limit`.
template <class Visit>
void VisitNear(const TriangleMesh& mesh, const FaceAdjacency& adjacency, uint32_t v, double limit, Visit visit) {
  const double reach2 = kProbeReach * kProbeReach * limit * limit;
  const auto consider = [&](VertexId neighbour) {
    if (SquaredDistance(mesh.positions[v], mesh.PositionAt(neighbour)) <= reach2) visit(neighbour.index());
  };
  const uint32_t first = adjacency.outgoing[v];
  for (uint32_t h = first; h != kNoHalfEdge;) {
    consider(TargetOf(mesh, h));
    const uint32_t next = adjacency.NextAroundOrigin(h);
    if (next == kNoHalfEdge) consider(OriginOf(mesh, PreviousHalfEdge(h)));
    if (next == first) return;
    h = next;
  }
}

// Greedily in the order of the vertices, so that it depends on the mesh alone.
std::vector<uint8_t> ChooseProbes(const TriangleMesh& mesh, const FaceAdjacency& adjacency,
                                  absl::Span<const double> limits) {
  std::vector<uint8_t> is_probe(mesh.positions.size(), 0), covered(mesh.positions.size(), 0);
  for (uint32_t v = 0; v < is_probe.size(); ++v) {
    if (covered[v]) continue;
    is_probe[v] = 1;
    VisitNear(mesh, adjacency, v, limits[v], [&](uint32_t neighbour) { covered[neighbour] = 1; });
  }
  return is_probe;
}

}  // namespace

absl::StatusOr<std::vector<double>> MeasureSheetDistances(const TriangleMesh& mesh, const FaceAdjacency& adjacency,
                                                          absl::Span<const Vec3> normals,
                                                          absl::Span<const double> limits, const Context& context) {
  const TriangleBvh bvh(mesh.positions, mesh.triangles);
  const FaceView view{mesh.positions.data(), mesh.triangles.data(), adjacency.opposite.data()->data(),
                      static_cast<uint32_t>(mesh.triangles.size())};
  const Sheets sheets{view, adjacency, normals, bvh};
  const std::vector<uint8_t> is_probe = ChooseProbes(mesh, adjacency, limits);
  std::vector<double> distances(mesh.positions.size(), INFINITY);
  MESHFRONT_RETURN_IF_ERROR(ParallelFor(distances.size(), kGrain, context, [&](size_t begin, size_t end) {
    FaceQueue queue;
    for (size_t v = begin; v < end; ++v) {
      if (is_probe[v]) distances[v] = SheetDistance(sheets, static_cast<uint32_t>(v), limits[v], queue);
    }
  }));
  MESHFRONT_RETURN_IF_ERROR(ParallelFor(distances.size(), kGrain, context, [&](size_t begin, size_t end) {
    for (size_t v = begin; v < end; ++v) {
      if (is_probe[v]) continue;
      VisitNear(mesh, adjacency, static_cast<uint32_t>(v), INFINITY, [&](uint32_t neighbour) {
        if (is_probe[neighbour]) distances[v] = std::min(distances[v], distances[neighbour]);
      });
    }
  }));
  return distances;
}

}  // namespace meshfront
