#include "core/mesh/triangle_mesh.h"

namespace meshfront {

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
