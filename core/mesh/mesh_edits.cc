#include "core/mesh/mesh_edits.h"

#include <vector>

namespace meshfront {

void FlipEdge(TriangleMesh& mesh, FaceAdjacency& adjacency, uint32_t h) {
  const uint32_t g = adjacency.OppositeOf(h);
  const VertexId u = OriginOf(mesh, h), v = TargetOf(mesh, h);
  const VertexId w = OriginOf(mesh, PreviousHalfEdge(h)), d = OriginOf(mesh, PreviousHalfEdge(g));
  const uint32_t f0 = 3 * FaceOfHalfEdge(h), g0 = 3 * FaceOfHalfEdge(g);
  const uint32_t across_vw = adjacency.OppositeOf(NextHalfEdge(h)),
                 across_wu = adjacency.OppositeOf(PreviousHalfEdge(h));
  const uint32_t across_ud = adjacency.OppositeOf(NextHalfEdge(g)),
                 across_dv = adjacency.OppositeOf(PreviousHalfEdge(g));
  mesh.triangles[f0 / 3] = {u, d, w};
  mesh.triangles[g0 / 3] = {d, v, w};
  LinkHalfEdges(adjacency, f0, across_ud);
  LinkHalfEdges(adjacency, f0 + 1, g0 + 2);
  LinkHalfEdges(adjacency, f0 + 2, across_wu);
  LinkHalfEdges(adjacency, g0, across_dv);
  LinkHalfEdges(adjacency, g0 + 1, across_vw);
}

void DropUnreferencedVertices(TriangleMesh& mesh, FaceAdjacency& adjacency) {
  std::vector<uint32_t> new_id(mesh.positions.size(), 0);
  for (const Triangle& t : mesh.triangles) {
    for (const VertexId v : t) new_id[v.index()] = 1;
  }
  const bool has_normals = mesh.normals.size() == mesh.positions.size();
  uint32_t count = 0;
  for (uint32_t v = 0; v < new_id.size(); ++v) {
    if (new_id[v] == 0) continue;
    mesh.positions[count] = mesh.positions[v];
    adjacency.outgoing[count] = adjacency.outgoing[v];
    if (has_normals) mesh.normals[count] = mesh.normals[v];
    new_id[v] = count++;
  }
  mesh.positions.resize(count);
  adjacency.outgoing.resize(count);
  if (has_normals) mesh.normals.resize(count);
  for (Triangle& t : mesh.triangles) {
    for (VertexId& v : t) v = VertexId(new_id[v.index()]);
  }
}

}  // namespace meshfront
