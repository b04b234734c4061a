// 1. vertices at the places of others    2. edges between such, by the places of their ends    3. those that are not alone
#include "core/features/seams.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>

#include "absl/container/flat_hash_map.h"

namespace meshfront {
namespace {

struct SeamEdge {
  std::pair<uint32_t, uint32_t> places;
  uint32_t half_edge;
  bool operator<(const SeamEdge& o) const { return places != o.places ? places < o.places : half_edge < o.half_edge; }
};

// Of each vertex the first one at its place; kNoHalfEdge where it is alone there.
std::vector<uint32_t> SharedPlaces(const std::vector<Vec3>& positions) {
  absl::flat_hash_map<std::array<double, 3>, uint32_t> first_at;
  first_at.reserve(positions.size());
  std::vector<uint32_t> place(positions.size(), kNoHalfEdge);
  for (uint32_t v = 0; v < positions.size(); ++v) {
    const Vec3& p = positions[v];
    const uint32_t first = first_at.try_emplace({p.x + 0.0, p.y + 0.0, p.z + 0.0}, v).first->second;  // −0 is 0
    if (first != v) place[v] = place[first] = first;
  }
  return place;
}

}  // namespace

void MarkSeams(const TriangleMesh& mesh, const FaceAdjacency& adjacency, std::vector<bool>& creases) {
  const std::vector<uint32_t> place = SharedPlaces(mesh.positions);
  std::vector<SeamEdge> edges;
  for (uint32_t h = 0; h < 3 * mesh.triangles.size(); ++h) {
    const uint32_t across = adjacency.OppositeOf(h);
    const uint32_t from = place[OriginOf(mesh, h).index()], to = place[TargetOf(mesh, h).index()];
    if (from == kNoHalfEdge || to == kNoHalfEdge || (across != kNoHalfEdge && across < h)) continue;
    edges.push_back({{std::min(from, to), std::max(from, to)}, h});
  }
  std::sort(edges.begin(), edges.end());
  for (size_t i = 0, end; i < edges.size(); i = end) {
    for (end = i + 1; end < edges.size() && edges[end].places == edges[i].places;) ++end;
    for (size_t k = i; k < end && end - i > 1; ++k) {
      const uint32_t across = adjacency.OppositeOf(edges[k].half_edge);
      if (across != kNoHalfEdge) creases[edges[k].half_edge] = creases[across] = true;
    }
  }
}

}  // namespace meshfront
