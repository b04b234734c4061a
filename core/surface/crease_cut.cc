#include "core/surface/crease_cut.h"

#include <numeric>
#include <utility>

namespace meshfront {

CreaseCut CutAlongCreases(TriangleMesh mesh, FaceAdjacency adjacency, const std::vector<bool>& creases) {
  CreaseCut cut{std::move(mesh), {}, {}, adjacency.opposite};
  const auto half_edges = static_cast<uint32_t>(3 * cut.mesh.triangles.size());
  std::vector<bool> is_cut(cut.mesh.positions.size()), keeps_name(cut.mesh.positions.size(), true);
  for (uint32_t h = 0; h < half_edges; ++h) {
    if (!creases[h] && adjacency.OppositeOf(h) != kNoHalfEdge)
      continue;  // at rims fans may touch, where a part was cut out
    is_cut[OriginOf(cut.mesh, h).index()] = true;
    adjacency.opposite[h / 3][h % 3] = kNoHalfEdge;
  }
  cut.original.resize(cut.mesh.positions.size());
  std::iota(cut.original.begin(), cut.original.end(), 0u);
  // Each fan of faces between two rims, from its first half-edge on; the first one met keeps the vertex.
  for (uint32_t h = 0; h < half_edges; ++h) {
    const uint32_t v = OriginOf(cut.mesh, h).index();
    if (v >= is_cut.size() || !is_cut[v] || adjacency.OppositeOf(h) != kNoHalfEdge) continue;
    uint32_t copy = v;
    if (!keeps_name[v]) {
      copy = static_cast<uint32_t>(cut.mesh.positions.size());
      cut.mesh.positions.push_back(Vec3(cut.mesh.positions[v]));
      cut.original.push_back(v);
      adjacency.outgoing.push_back(h);
    }
    keeps_name[v] = false;
    adjacency.outgoing[copy] = h;
    for (uint32_t g = h; g != kNoHalfEdge; g = adjacency.NextAroundOrigin(g))
      cut.mesh.triangles[g / 3][g % 3] = VertexId(copy);
  }
  cut.adjacency = std::move(adjacency);
  return cut;
}

}  // namespace meshfront
