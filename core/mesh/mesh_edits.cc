#include "core/mesh/mesh_edits.h"

#include <algorithm>
#include <vector>

namespace meshfront {
namespace {

uint32_t& WedgeOf(TriangleMesh& mesh, uint32_t h) { return mesh.attributes.corners[h / 3][h % 3]; }

bool SameValues(const MeshAttributes& a, uint32_t w, uint32_t x) {
  if (w == x) return true;
  const absl::Span<const float> of_w = a.WedgeAt(w), of_x = a.WedgeAt(x);
  return std::equal(of_w.begin(), of_w.end(), of_x.begin());
}

// Of FlipEdge: where a seam runs along the edge, the apex w of the cap gets what the face across has there.
void FlipWedges(TriangleMesh& mesh, uint32_t h, uint32_t g) {
  MeshAttributes& a = mesh.attributes;
  if (!a.groups.empty()) a.groups[h / 3] = a.groups[g / 3];
  if (a.corners.empty()) return;
  const uint32_t u_cap = WedgeOf(mesh, h), v_cap = WedgeOf(mesh, NextHalfEdge(h));
  const uint32_t v = WedgeOf(mesh, g), u = WedgeOf(mesh, NextHalfEdge(g)), d = WedgeOf(mesh, PreviousHalfEdge(g));
  uint32_t w = WedgeOf(mesh, PreviousHalfEdge(h));
  if (!SameValues(a, u_cap, u) || !SameValues(a, v_cap, v)) {
    const Vec3 &from = mesh.PositionAt(OriginOf(mesh, h)), &to = mesh.PositionAt(TargetOf(mesh, h));
    const Vec3& apex = mesh.PositionAt(OriginOf(mesh, PreviousHalfEdge(h)));
    const double length2 = SquaredDistance(from, to);
    const double t = length2 > 0 ? Dot(apex - from, to - from) / length2 : 0;
    w = AddWedgeBetween(a, u, v, std::clamp(t, 0.0, 1.0));
  }
  a.corners[h / 3] = {u, d, w};
  a.corners[g / 3] = {d, v, w};
}

}  // namespace

void MoveWedges(TriangleMesh& mesh, uint32_t h, uint32_t g, const std::vector<uint32_t>& fan) {
  if (mesh.attributes.corners.empty()) return;
  const uint32_t from[2] = {WedgeOf(mesh, h), WedgeOf(mesh, NextHalfEdge(g))};
  const uint32_t to[2] = {WedgeOf(mesh, NextHalfEdge(h)), WedgeOf(mesh, g)};
  for (const uint32_t e : fan) {
    uint32_t& wedge = WedgeOf(mesh, e);
    for (int side : {0, 1}) {
      if (!SameValues(mesh.attributes, wedge, from[side])) continue;
      wedge = to[side];
      break;
    }
  }
}

void FlipEdge(TriangleMesh& mesh, FaceAdjacency& adjacency, uint32_t h) {
  const uint32_t g = adjacency.OppositeOf(h);
  const VertexId u = OriginOf(mesh, h), v = TargetOf(mesh, h);
  const VertexId w = OriginOf(mesh, PreviousHalfEdge(h)), d = OriginOf(mesh, PreviousHalfEdge(g));
  const uint32_t f0 = 3 * FaceOfHalfEdge(h), g0 = 3 * FaceOfHalfEdge(g);
  const uint32_t across_vw = adjacency.OppositeOf(NextHalfEdge(h)),
                 across_wu = adjacency.OppositeOf(PreviousHalfEdge(h));
  const uint32_t across_ud = adjacency.OppositeOf(NextHalfEdge(g)),
                 across_dv = adjacency.OppositeOf(PreviousHalfEdge(g));
  FlipWedges(mesh, h, g);
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
