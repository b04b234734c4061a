// 1. the mesh before it was cut    2. where it was cut, and the sides of the faces around the places, or its creases
// 3. the surface again
#include "core/loose_faces.h"

#include <algorithm>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "core/base/status_macros.h"
#include "core/features/creases.h"
#include "core/features/seams.h"
#include "core/geometry/bvh.h"
#include "core/geometry/triangle.h"
#include "core/mesh/adjacency.h"

namespace meshfront {
namespace {

std::vector<bool> CutsOf(const MeshSurface& surface) {
  std::vector<bool> cuts(3 * surface.mesh().triangles.size());
  for (uint32_t h = 0; h < cuts.size(); ++h) cuts[h] = surface.AcrossCrease(h) != kNoHalfEdge;
  return cuts;
}

template <class Visit>
void VisitFacesWithin(const TriangleBvh& tree, const TriangleMesh& mesh, const Vec3& place, double radius,
                      Visit visit) {
  const Vec3 reach{radius, radius, radius};
  Box3 box;
  box.Extend(place - reach);
  box.Extend(place + reach);
  tree.VisitOverlaps(box, [&](FaceId f) {
    const Triangle& t = mesh.triangles[f.index()];
    const Vec3 nearest =
        ClosestPointOnTriangle(place, mesh.PositionAt(t[0]), mesh.PositionAt(t[1]), mesh.PositionAt(t[2])).position;
    if (Distance(nearest, place) <= radius) visit(f.index());
    return true;
  });
}

// The surface of the preparation, cut open as the flags of the half-edges say.
absl::Status CutAgain(TriangleMesh mesh, FaceAdjacency adjacency, std::vector<bool> cuts, Preparation& p,
                      const Context& context) {
  MarkSeams(mesh, adjacency, cuts);
  MESHFRONT_ASSIGN_OR_RETURN(auto surface, MeshSurface::Create(std::move(mesh), std::move(adjacency), cuts, context));
  if (p.region) {
    surface->TakeBorderFrom(*p.surface);
    const RemeshOptions& options = p.parameters.options;
    MESHFRONT_ASSIGN_OR_RETURN(p.region->blend, RegionBlend::Create(*surface, options.blend, options.eta, context));
  }
  MESHFRONT_RETURN_IF_ERROR(surface->ComputeCurvature(context));
  auto builder = std::make_shared<FieldBuilder>(*surface, *p.builder);
  p.surface = std::move(surface);
  p.builder = std::move(builder);
  p.seeds = p.surface->Seeds();
  return absl::OkStatus();
}

absl::Status NoOrientedManifold() {
  return absl::InternalError("a surface's mesh is no oriented manifold; please report this mesh");
}

}  // namespace

absl::Status CutFacesLoose(absl::Span<const Vec3> places, double reach, Preparation& p, const Context& context) {
  TriangleMesh mesh = p.surface->MeshBeforeCut();
  std::optional<FaceAdjacency> adjacency = FindOrientedAdjacency(mesh);
  if (!adjacency) return NoOrientedManifold();
  std::vector<bool> cuts = CutsOf(*p.surface);
  const TriangleBvh tree(mesh.positions, mesh.triangles);
  for (const Vec3& place : places) {
    MESHFRONT_RETURN_IF_ERROR(context.CheckStop());
    VisitFacesWithin(tree, mesh, place, reach * p.field->At(place), [&](uint32_t f) {
      for (uint32_t h = 3 * f; h < 3 * f + 3; ++h) {
        const uint32_t across = adjacency->OppositeOf(h);
        if (across != kNoHalfEdge) cuts[h] = cuts[across] = true;
      }
    });
  }
  return CutAgain(std::move(mesh), *std::move(adjacency), std::move(cuts), p, context);
}

absl::StatusOr<bool> CutAlongCreases(double angle, Preparation& p, const Context& context) {
  TriangleMesh mesh = p.surface->MeshBeforeCut();
  std::optional<FaceAdjacency> adjacency = FindOrientedAdjacency(mesh);
  if (!adjacency) return NoOrientedManifold();
  MESHFRONT_ASSIGN_OR_RETURN(std::vector<bool> cuts, FindCreases(mesh, *adjacency, angle, context));
  if (std::find(cuts.begin(), cuts.end(), true) == cuts.end()) return false;
  MESHFRONT_RETURN_IF_ERROR(CutAgain(std::move(mesh), *std::move(adjacency), std::move(cuts), p, context));
  return true;
}

}  // namespace meshfront
