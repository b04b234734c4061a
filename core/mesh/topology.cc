// Counts of a mesh.
//
// 1. MeasureOriented: an oriented manifold, what the engine takes and gives, is counted from its adjacency.
// 2. MeasureAny: everything else, edge by edge. Two corners belong to one fan when they lie at the same end of an edge
//    with two faces; components, fans, rims and orientations are unions of what edges connect.
#include "core/mesh/topology.h"

#include <algorithm>

#include "core/mesh/adjacency.h"
#include "core/mesh/union_find.h"

namespace meshfront {
namespace {

// Triangles that take part: three different finite corners.
bool IsUsable(const TriangleMesh& mesh, const Triangle& t) {
  return t[0] != t[1] && t[1] != t[2] && t[2] != t[0] && IsFinite(mesh.PositionAt(t[0])) &&
         IsFinite(mesh.PositionAt(t[1])) && IsFinite(mesh.PositionAt(t[2]));
}

void Conclude(uint64_t edges, TopologyReport& out) {
  out.euler_characteristic = int64_t(out.vertices) - int64_t(edges) + int64_t(out.triangles);
  out.closed = out.triangles > 0 && out.boundary_edges == 0;
}

// Σ (2 − χ − loops) / 2 over the components.
int64_t GenusOf(const TopologyReport& t) {
  return (2 * int64_t(t.components) - t.euler_characteristic - int64_t(t.boundary_loops)) / 2;
}

TopologyReport MeasureOriented(const TriangleMesh& mesh, const FaceAdjacency& adjacency, uint64_t components) {
  TopologyReport out;
  out.triangles = mesh.triangles.size();
  for (const uint32_t h : adjacency.outgoing) out.vertices += h != kNoHalfEdge;
  for (const auto& sides : adjacency.opposite) {
    for (const uint32_t h : sides) out.boundary_edges += h == kNoHalfEdge;
  }
  out.boundary_loops = FindBoundaryLoops(adjacency).size();
  out.components = components;
  out.manifold = out.oriented = out.triangles > 0;
  Conclude((3 * out.triangles + out.boundary_edges) / 2, out);
  if (out.manifold) out.genus = GenusOf(out);
  return out;
}

class AnyMesh {
 public:
  explicit AnyMesh(const TriangleMesh& mesh)
      : mesh_(mesh),
        vertices_(mesh.positions.size()),
        corners_(3 * mesh.triangles.size()),
        faces_(mesh.triangles.size()) {}

  TopologyReport Measure() {
    out_.oriented = true;
    const std::vector<uint32_t> order = HalfEdgesByEdge(mesh_);
    uint64_t edges = 0;
    for (size_t i = 0, end; i < order.size(); i = end, ++edges) {
      const auto [a, b] = EndsOf(order[i]);
      for (end = i + 1; end < order.size() && EndsOf(order[end]) == std::pair(a, b);) ++end;
      AddEdge(&order[i], end - i);
    }
    CountVertices();
    CountLoops();
    out_.triangles = order.size() / 3;
    manifold_ = manifold_ && out_.triangles > 0;
    out_.manifold = manifold_;
    out_.oriented = out_.oriented && out_.triangles > 0;
    Conclude(edges, out_);
    if (manifold_ && orientable_) out_.genus = GenusOf(out_);
    return out_;
  }

 private:
  std::pair<uint32_t, uint32_t> EndsOf(uint32_t h) const {
    const uint32_t a = OriginOf(mesh_, h).index(), b = TargetOf(mesh_, h).index();
    return {std::min(a, b), std::max(a, b)};
  }
  // The corners of h's face at the smaller and at the larger end of h.
  std::pair<uint32_t, uint32_t> CornersOf(uint32_t h) const {
    const uint32_t next = NextHalfEdge(h);
    return OriginOf(mesh_, h) < OriginOf(mesh_, next) ? std::pair(h, next) : std::pair(next, h);
  }

  void AddEdge(const uint32_t* half_edges, size_t count) {
    const auto [a, b] = EndsOf(half_edges[0]);
    vertices_.Unite(a, b);
    if (count == 1) rim_.push_back(half_edges[0]);
    if (count > 2) manifold_ = out_.oriented = false;
    if (count != 2) return;
    const auto [a0, b0] = CornersOf(half_edges[0]);
    const auto [a1, b1] = CornersOf(half_edges[1]);
    corners_.Unite(a0, a1);
    corners_.Unite(b0, b1);
    const bool same_direction = OriginOf(mesh_, half_edges[0]) == OriginOf(mesh_, half_edges[1]);
    if (same_direction) out_.oriented = false;
    if (!faces_.Unite(FaceOfHalfEdge(half_edges[0]), FaceOfHalfEdge(half_edges[1]), same_direction))
      orientable_ = false;
  }

  void CountVertices() {
    std::vector<bool> used(mesh_.positions.size(), false);
    for (uint32_t corner = 0; corner < 3 * mesh_.triangles.size(); ++corner) {
      if (corner % 3 == 0 && !IsUsable(mesh_, mesh_.triangles[corner / 3])) {
        corner += 2;
        continue;
      }
      if (corners_.Find(corner) != corner) continue;  // counted with the fan's first corner
      const uint32_t v = OriginOf(mesh_, corner).index();
      if (used[v]) manifold_ = false;
      used[v] = true;
    }
    for (uint32_t v = 0; v < used.size(); ++v) {
      out_.vertices += used[v];
      out_.components += used[v] && vertices_.Find(v) == v;
    }
  }

  // Rim edges are one chain where they end in the same fan.
  void CountLoops() {
    out_.boundary_edges = rim_.size();
    std::vector<uint32_t> first(rim_.empty() ? 0 : 3 * mesh_.triangles.size(), kNoHalfEdge);
    UnionFind chains(rim_.size());
    uint64_t links = 0;
    for (uint32_t i = 0; i < rim_.size(); ++i) {
      for (const uint32_t corner : {rim_[i], NextHalfEdge(rim_[i])}) {
        uint32_t& other = first[corners_.Find(corner)];
        if (other == kNoHalfEdge)
          other = i;
        else
          links += chains.Unite(other, i);
      }
    }
    out_.boundary_loops = rim_.size() - links;
  }

  const TriangleMesh& mesh_;
  UnionFind vertices_, corners_;
  ParityUnionFind faces_;
  std::vector<uint32_t> rim_;
  bool manifold_ = true, orientable_ = true;
  TopologyReport out_;
};

}  // namespace

TopologyReport MeasureTopology(const TriangleMesh& mesh) {
  const bool all_usable =
      std::all_of(mesh.triangles.begin(), mesh.triangles.end(), [&](const Triangle& t) { return IsUsable(mesh, t); });
  if (!all_usable) {
    TriangleMesh usable;
    usable.positions = mesh.positions;
    std::copy_if(mesh.triangles.begin(), mesh.triangles.end(), std::back_inserter(usable.triangles),
                 [&](const Triangle& t) { return IsUsable(mesh, t); });
    return AnyMesh(usable).Measure();
  }
  const std::optional<FaceAdjacency> adjacency = FindOrientedAdjacency(mesh);
  if (adjacency && HasSingleFans(mesh, *adjacency)) return MeasureTopology(mesh, *adjacency);
  return AnyMesh(mesh).Measure();
}

TopologyReport MeasureTopology(const TriangleMesh& mesh, const FaceAdjacency& adjacency) {
  return MeasureOriented(mesh, adjacency, LabelComponents(adjacency).count);
}

TopologyReport MeasureTopology(const TriangleMesh& mesh, const FaceAdjacency& adjacency, uint64_t components) {
  return MeasureOriented(mesh, adjacency, components);
}

}  // namespace meshfront
