// Who lies across each side of each triangle: the half-edge structure of a mesh, in flat arrays.
//
//   const FaceAdjacency adjacency = CreateAdjacency(mesh);
//   VisitOutgoing(adjacency, v, [&](uint32_t h) { Visit(FaceOfHalfEdge(h)); });  // the faces around v
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/base/ids.h"
#include "core/mesh/triangle_mesh.h"

namespace meshfront {

// Half-edge 3 f + i runs along face f from its corner i to its corner i + 1 (mod 3), the face on its left.
inline constexpr uint32_t kNoHalfEdge = 0xffffffffu;
constexpr uint32_t FaceOfHalfEdge(uint32_t h) { return h / 3; }
constexpr uint32_t NextHalfEdge(uint32_t h) { return h % 3 == 2 ? h - 2 : h + 1; }
constexpr uint32_t PreviousHalfEdge(uint32_t h) { return h % 3 == 0 ? h + 2 : h - 1; }

struct FaceAdjacency {
  // opposite[f][i]: the half-edge across side i of face f, or kNoHalfEdge at the rim.
  std::vector<std::array<uint32_t, 3>> opposite;
  // outgoing[v]: a half-edge that leaves v; the one on the rim where there is one, so that NextAroundOrigin from there
  // covers the whole fan. kNoHalfEdge for a vertex that no triangle uses.
  std::vector<uint32_t> outgoing;

  // opposite[h / 3][h % 3]: the arrays lie one behind the other.
  uint32_t OppositeOf(uint32_t h) const { return opposite.data()->data()[h]; }
  // The next half-edge counter-clockwise that leaves the same vertex; kNoHalfEdge beyond the last one at a rim.
  uint32_t NextAroundOrigin(uint32_t h) const { return OppositeOf(PreviousHalfEdge(h)); }
  bool IsRimVertex(uint32_t v) const { return outgoing[v] != kNoHalfEdge && OppositeOf(outgoing[v]) == kNoHalfEdge; }
};

// Calls visit(h) for each half-edge that leaves v, counter-clockwise; at a rim from the one on it on. The rim's last edge has none.
template <class Visit>
void VisitOutgoing(const FaceAdjacency& adjacency, uint32_t v, Visit&& visit) {
  const uint32_t first = adjacency.outgoing[v];
  for (uint32_t h = first; h != kNoHalfEdge;) {
    visit(h);
    h = adjacency.NextAroundOrigin(h);
    if (h == first) return;
  }
}

inline VertexId OriginOf(const TriangleMesh& mesh, uint32_t h) { return mesh.triangles[h / 3][h % 3]; }
inline VertexId TargetOf(const TriangleMesh& mesh, uint32_t h) { return OriginOf(mesh, NextHalfEdge(h)); }

inline double SquaredLength(const TriangleMesh& mesh, uint32_t h) {
  return SquaredDistance(mesh.PositionAt(OriginOf(mesh, h)), mesh.PositionAt(TargetOf(mesh, h)));
}
// The half-edge along the longest and the shortest side of face f; of sides of one length the first.
inline uint32_t LongestSide(const TriangleMesh& mesh, uint32_t f) {
  const double s0 = SquaredLength(mesh, 3 * f), s1 = SquaredLength(mesh, 3 * f + 1),
               s2 = SquaredLength(mesh, 3 * f + 2);
  return 3 * f + (s0 >= s1 && s0 >= s2 ? 0 : s1 >= s2 ? 1 : 2);
}
inline uint32_t ShortestSide(const TriangleMesh& mesh, uint32_t f) {
  const double s0 = SquaredLength(mesh, 3 * f), s1 = SquaredLength(mesh, 3 * f + 1),
               s2 = SquaredLength(mesh, 3 * f + 2);
  return 3 * f + (s0 <= s1 && s0 <= s2 ? 0 : s1 <= s2 ? 1 : 2);
}

// Calls visit(VertexId) for each vertex that shares an edge with v, counter-clockwise.
template <class Visit>
void VisitNeighbours(const TriangleMesh& mesh, const FaceAdjacency& adjacency, uint32_t v, Visit&& visit) {
  VisitOutgoing(adjacency, v, [&](uint32_t h) {
    visit(TargetOf(mesh, h));
    if (adjacency.NextAroundOrigin(h) == kNoHalfEdge) visit(OriginOf(mesh, PreviousHalfEdge(h)));  // along the rim
  });
}

// The adjacency of an oriented manifold mesh whose indices are in range (what RepairMesh returns). On any other mesh,
// half-edges that have no single partner in the opposite direction count as rim. O(n), about 30 ns a triangle; at most
// 2^32 / 3 triangles.
FaceAdjacency CreateAdjacency(const TriangleMesh& mesh);
// The same, or nothing when an edge has more than two faces, two faces run through an edge in the same direction, or a
// triangle names a vertex twice. Vertices whose faces are not one fan are not looked for (HasSingleFans).
std::optional<FaceAdjacency> FindOrientedAdjacency(const TriangleMesh& mesh);
// The box of the vertices that a triangle names, as BoundingBox(mesh), in a quarter of the time.
Box3 BoundingBox(const TriangleMesh& mesh, const FaceAdjacency& adjacency);
// Whether the faces at every vertex are one fan: no two sheets touch in a vertex only. O(n).
bool HasSingleFans(const TriangleMesh& mesh, const FaceAdjacency& adjacency);

// The rims: closed chains of half-edges without a partner, the mesh on their left, each followed around its vertices
// inside their fans (two sheets that touch in a vertex have two loops). In the order of their smallest half-edge.
std::vector<std::vector<uint32_t>> FindBoundaryLoops(const FaceAdjacency& adjacency);

// Faces connected across edges. Components are numbered in the order of their first face.
struct FaceComponents {
  uint32_t count = 0;
  std::vector<uint32_t> label;  // one per face
};
FaceComponents LabelComponents(const FaceAdjacency& adjacency);

// All half-edges ordered by their edge: smaller end vertex, larger end vertex, code. For meshes of any kind; triangles
// with a repeated index are left out. Guaranteed O(n + vertices).
std::vector<uint32_t> HalfEdgesByEdge(const TriangleMesh& mesh);

}  // namespace meshfront
