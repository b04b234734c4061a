#include "core/mesh/triangle_mesh.h"

namespace meshfront {

void DropTriangles(TriangleMesh& mesh, const std::vector<bool>& dropped) {
  const bool has_origins = !mesh.face_origins.empty();
  size_t kept = 0;
  for (size_t f = 0; f < mesh.triangles.size(); ++f) {
    if (dropped[f]) continue;
    if (has_origins) mesh.face_origins[kept] = mesh.face_origins[f];
    mesh.triangles[kept++] = mesh.triangles[f];
  }
  mesh.triangles.resize(kept);
  if (has_origins) mesh.face_origins.resize(kept);
}

Box3 BoundingBox(const TriangleMesh& mesh) {
  Box3 box;
  if (mesh.IsPointSet()) {
    for (const Vec3& p : mesh.positions) box.Extend(p);
  }
  for (const Triangle& t : mesh.triangles) {
    for (const VertexId v : t) box.Extend(mesh.PositionAt(v));
  }
  return box;
}

}  // namespace meshfront
