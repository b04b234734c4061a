// 1. Choose the vertices to probe, so that every other has one next to it, near against its limit (ChooseProbes). 2. A coarse grid
// rules out most rays: those that pass only cells without a face that looks the other way (NormalGrid). 3. From each probe a ray
// inwards and one outwards, first hit among the faces in the cells that are left and that look the other way (FindOpposedHit);
// 4. unless that face is reached along the surface by a short way (IsNearAlongSurface): then it is the same sheet, bent. 5. The
// others take the least of the probes next to them.
// Rejected: the closest opposed point instead of rays. It grows with every detail near by and costs four times as much.
#include "core/surface/sheet_distance.h"

#include <algorithm>
#include <cmath>

#include "core/base/status_macros.h"
#include "core/geometry/bvh.h"
#include "core/geometry/triangle.h"
#include "core/surface/face_queue.h"
#include "core/surface/normal_grid.h"
#include "core/surface/tolerances.h"

namespace meshfront {
namespace {

using namespace surface_tolerances;

constexpr size_t kGrain = 512;
// Cells against the way that a ray looks: small enough that the sheet that it starts from seldom turns within them.
constexpr double kCellOfLimit = 0.5;

// What rays may hit: the faces that the cells of the grid don't rule out.
struct Suspects {
  std::vector<uint32_t> faces;  // of the mesh, increasing
  std::vector<Triangle> triangles;
};

struct Sheets {
  FaceView mesh;
  const FaceAdjacency& adjacency;
  absl::Span<const Vec3> normals;
  const Suspects& suspects;
  const TriangleBvh& bvh;                // over the suspects
  absl::Span<const uint32_t> originals;  // of the vertices before a cut; empty: they are

  uint32_t OriginalOf(uint32_t v) const { return originals.empty() ? v : originals[v]; }
};

// A ray from a vertex: 0 along minus its normal, 1 along its normal.
constexpr double kSigns[2] = {-1.0, 1.0};
// Bit i of a byte: ray i may hit a sheet.
using Rays = uint8_t;

// Of those that ask at all.
double MeanOf(absl::Span<const double> limits) {
  double sum = 0;
  size_t count = 0;
  for (const double limit : limits) sum += limit, count += limit > 0;
  return count == 0 ? 0 : sum / static_cast<double>(count);
}

std::optional<SegmentHit> FindOpposedHit(const Sheets& sheets, uint32_t v, const Vec3& direction, double limit) {
  const Vec3& normal = sheets.normals[v];
  const uint32_t start = sheets.OriginalOf(v);
  auto hit = sheets.bvh.FindFirstHit(sheets.mesh.positions[v], direction, 0, limit, [&](FaceId face) {
    const Triangle& t = sheets.suspects.triangles[face.index()];
    const auto is_start = [&](VertexId u) { return sheets.OriginalOf(u.index()) == start; };
    if (is_start(t[0]) || is_start(t[1]) || is_start(t[2])) return false;
    const Vec3* const p = sheets.mesh.positions;
    const Vec3 area = AreaVector(p[t[0].index()], p[t[1].index()], p[t[2].index()]);
    const double along = Dot(area, normal);
    return along < 0 && along * along > kOpposed * kOpposed * SquaredNorm(area);
  });
  if (hit) hit->face = FaceId(sheets.suspects.faces[hit->face.index()]);
  return hit;
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

double SheetDistance(const Sheets& sheets, uint32_t v, double limit, Rays rays, FaceQueue& queue) {
  double nearest = INFINITY;
  for (int i = 0; i < 2; ++i) {
    if (!(rays >> i & 1)) continue;
    const auto hit = FindOpposedHit(sheets, v, kSigns[i] * sheets.normals[v], std::min(limit, nearest));
    if (hit && hit->t < nearest && !IsNearAlongSurface(sheets, v, *hit, queue)) nearest = hit->t;
  }
  return nearest;
}

// Calls visit(neighbour) for the vertices around v that are near against `limit`.
template <class Visit>
void VisitNear(const TriangleMesh& mesh, const FaceAdjacency& adjacency, uint32_t v, double limit, Visit visit) {
  const double reach2 = kProbeReach * kProbeReach * limit * limit;
  VisitNeighbours(mesh, adjacency, v, [&](VertexId neighbour) {
    if (SquaredDistance(mesh.positions[v], mesh.PositionAt(neighbour)) <= reach2) visit(neighbour.index());
  });
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

Rays SuspectRays(const NormalGrid& grid, const Vec3& from, const Vec3& normal, double limit) {
  Rays rays = 0;
  for (int i = 0; i < 2; ++i) {
    rays |= static_cast<Rays>(grid.MayMeetOpposed(from, from + kSigns[i] * limit * normal, normal) << i);
  }
  return rays;
}

Suspects CollectSuspects(const TriangleMesh& mesh, absl::Span<const Vec3> normals, absl::Span<const double> limits,
                         absl::Span<const Rays> rays, NormalGrid& grid) {
  for (size_t v = 0; v < rays.size(); ++v) {
    for (int i = 0; i < 2; ++i) {
      const Vec3& from = mesh.positions[v];
      if (rays[v] >> i & 1) grid.MarkOpposed(from, from + kSigns[i] * limits[v] * normals[v], normals[v]);
    }
  }
  Suspects suspects{grid.FacesInMarked(), {}};
  suspects.triangles.reserve(suspects.faces.size());
  for (const uint32_t f : suspects.faces) suspects.triangles.push_back(mesh.triangles[f]);
  return suspects;
}

}  // namespace

absl::StatusOr<std::vector<double>> MeasureSheetDistances(const TriangleMesh& mesh, const FaceAdjacency& adjacency,
                                                          absl::Span<const Vec3> normals,
                                                          absl::Span<const double> limits, const Context& context,
                                                          const UncutMesh& uncut) {
  const auto* const opposite = uncut.opposite.empty() ? adjacency.opposite.data() : uncut.opposite.data();
  const FaceView view{mesh.positions.data(), mesh.triangles.data(), opposite->data(),
                      static_cast<uint32_t>(mesh.triangles.size())};
  const std::vector<uint8_t> is_probe = ChooseProbes(mesh, adjacency, limits);
  std::vector<Rays> rays(mesh.positions.size(), 0);
  Suspects suspects;
  {
    NormalGrid grid(view, mesh.positions.size(), BoundingBox(mesh, adjacency), kCellOfLimit * MeanOf(limits));
    MESHFRONT_RETURN_IF_ERROR(ParallelFor(rays.size(), kGrain, context, [&](size_t begin, size_t end) {
      for (size_t v = begin; v < end; ++v) {
        const bool asks = is_probe[v] && adjacency.outgoing[v] != kNoHalfEdge && limits[v] > 0;
        if (asks) rays[v] = SuspectRays(grid, mesh.positions[v], normals[v], limits[v]);
      }
    }));
    suspects = CollectSuspects(mesh, normals, limits, rays, grid);
  }
  const TriangleBvh bvh(mesh.positions, suspects.triangles);
  const Sheets sheets{view, adjacency, normals, suspects, bvh, uncut.originals};
  std::vector<double> distances(mesh.positions.size(), INFINITY);
  MESHFRONT_RETURN_IF_ERROR(ParallelFor(distances.size(), kGrain, context, [&](size_t begin, size_t end) {
    FaceQueue queue;
    for (size_t v = begin; v < end; ++v) {
      if (rays[v] != 0) distances[v] = SheetDistance(sheets, static_cast<uint32_t>(v), limits[v], rays[v], queue);
    }
  }));
  // To what lies beside a probe, from the few that met another sheet.
  for (uint32_t v = 0; v < distances.size(); ++v) {
    if (!is_probe[v] || std::isinf(distances[v])) continue;
    VisitNear(mesh, adjacency, v, INFINITY, [&](uint32_t neighbour) {
      if (!is_probe[neighbour]) distances[neighbour] = std::min(distances[neighbour], distances[v]);
    });
  }
  return distances;
}

}  // namespace meshfront
