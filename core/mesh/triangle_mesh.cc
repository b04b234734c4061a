#include "core/mesh/triangle_mesh.h"

#include <utility>

namespace meshfront {

void MoveFace(TriangleMesh& mesh, size_t from, size_t to) {
  mesh.triangles[to] = mesh.triangles[from];
  if (!mesh.face_origins.empty()) mesh.face_origins[to] = mesh.face_origins[from];
  MeshAttributes& a = mesh.attributes;
  if (!a.corners.empty()) a.corners[to] = a.corners[from];
  if (!a.groups.empty()) a.groups[to] = a.groups[from];
}

void ResizeFaces(TriangleMesh& mesh, size_t count) {
  mesh.triangles.resize(count);
  if (!mesh.face_origins.empty()) mesh.face_origins.resize(count);
  if (!mesh.attributes.corners.empty()) mesh.attributes.corners.resize(count);
  if (!mesh.attributes.groups.empty()) mesh.attributes.groups.resize(count);
}

void DropTriangles(TriangleMesh& mesh, const std::vector<bool>& dropped) {
  size_t kept = 0;
  for (size_t f = 0; f < dropped.size(); ++f) {
    if (!dropped[f]) MoveFace(mesh, f, kept++);
  }
  ResizeFaces(mesh, kept);
}

void ReverseFace(TriangleMesh& mesh, size_t face) {
  std::swap(mesh.triangles[face][1], mesh.triangles[face][2]);
  if (!mesh.attributes.corners.empty()) std::swap(mesh.attributes.corners[face][1], mesh.attributes.corners[face][2]);
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
