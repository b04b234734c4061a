#include "core/missed_places.h"

#include <algorithm>
#include <cmath>

#include "core/geometry/bvh.h"

namespace meshfront {
namespace {

constexpr size_t kLookedAt = 20000, kListed = 48;
// Farther than this part of g, and of the nearest triangle's longest side. Such sides that subtend 2π/3 leave the surface by 0.29 of their
// length, and tips are cut by somewhat more.
constexpr double kFarPerLength = 0.8;

double LongestSideOf(const TriangleMesh& mesh, const Triangle& t) {
  double longest2 = 0;
  for (int i = 0; i < 3; ++i)
    longest2 = std::max(longest2, SquaredDistance(mesh.PositionAt(t[i]), mesh.PositionAt(t[(i + 1) % 3])));
  return std::sqrt(longest2);
}

}  // namespace

MissedPlaces FindMissed(const MeshSurface& surface, const GuidanceField& field, const TriangleMesh& output) {
  MissedPlaces missed;
  if (output.triangles.empty()) return missed;
  const TriangleBvh tree(output.positions, output.triangles);
  const std::vector<Vec3>& vertices = surface.mesh().positions;
  const size_t stride = vertices.size() / kLookedAt + 1;
  std::vector<Vec3> all;
  for (size_t v = 0; v < vertices.size(); v += stride) {
    const uint32_t h = surface.adjacency().outgoing[v];
    if (h == kNoHalfEdge) continue;
    const double far = kFarPerLength * field.At(vertices[v]);
    if (tree.FindClosestPoint(vertices[v], far)) continue;
    const std::optional<ClosestHit> hit = tree.FindClosestPoint(vertices[v]);
    const double side = hit ? LongestSideOf(output, output.triangles[hit->face.index()]) : 0;
    if (hit && std::sqrt(hit->squared_distance) <= kFarPerLength * side) continue;
    all.push_back(vertices[v]);
    missed.components.push_back(surface.WholeComponentOf(surface.ComponentOf(FaceId(FaceOfHalfEdge(h)))));
  }
  std::sort(missed.components.begin(), missed.components.end());
  missed.components.erase(std::unique(missed.components.begin(), missed.components.end()), missed.components.end());
  const size_t step = all.size() / kListed + 1;
  for (size_t i = 0; i < all.size(); i += step) missed.places.push_back(all[i]);
  return missed;
}

}  // namespace meshfront
