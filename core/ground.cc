#include "core/ground.h"

#include <cstdint>
#include <vector>

#include "core/geometry/triangle.h"

namespace meshfront {
namespace {

// Of scans that the front meshes well one edge in 300 turns sharply at most.
constexpr double kRoughShare = 0.005, kRoughCosine = 0.17;  // 80°
constexpr double kBackCosine = -0.866;                      // 150°
constexpr double kLongPerGuidance = 2;                      // of an edge that turns so far

}  // namespace

Ground GroundOf(const MeshSurface& surface, const GuidanceField& field) {
  const TriangleMesh& mesh = surface.mesh();
  std::vector<Vec3> normals;
  normals.reserve(mesh.triangles.size());
  for (const Triangle& t : mesh.triangles)
    normals.push_back(Normalized(AreaVector(mesh.PositionAt(t[0]), mesh.PositionAt(t[1]), mesh.PositionAt(t[2]))));
  Ground ground;
  uint64_t sharp = 0, edges = 0;
  for (uint32_t h = 0; h < 3 * mesh.triangles.size(); ++h) {
    const uint32_t across = surface.adjacency().OppositeOf(h);
    if (across == kNoHalfEdge || across < h) continue;
    const double cosine = Dot(normals[h / 3], normals[across / 3]);
    ++edges;
    sharp += cosine < kRoughCosine;
    if (cosine >= kBackCosine || ground.folds_back) continue;
    const Triangle& t = mesh.triangles[h / 3];
    const Vec3 &from = mesh.PositionAt(t[h % 3]), &to = mesh.PositionAt(t[(h + 1) % 3]);
    ground.folds_back = Distance(from, to) > kLongPerGuidance * field.At(0.5 * (from + to));
  }
  ground.is_rough = static_cast<double>(sharp) > kRoughShare * static_cast<double>(edges);
  return ground;
}

}  // namespace meshfront
