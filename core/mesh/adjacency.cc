// Partners of half-edges.
//
// 1. ChainedPairing: every edge becomes an entry in a list at its smaller end vertex; a half-edge looks its edge up
//    there and either adds it or meets its partner. One pass, lists of three on average.
// 2. Where a list grows long (a hub with thousands of edges would make 1 quadratic), SortedPairing: half-edges in the
//    order of their edges by two counting passes, partners side by side.
// Rejected: a hash map of edges; three times slower, and the order of its memory is not the mesh's.
#include "core/mesh/adjacency.h"

#include <algorithm>

namespace meshfront {
namespace {

constexpr uint32_t kLongestChain = 128;

enum class Pairing { kOriented, kNotOrientedManifold, kChainTooLong };

struct EdgeEntry {
  uint32_t larger_end;
  uint32_t next;       // entry of the same list
  uint32_t half_edge;  // the first that came
};

bool HasRepeatedIndex(const Triangle& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; }

void ClearOpposites(size_t faces, FaceAdjacency& out) {
  out.opposite.assign(faces, {kNoHalfEdge, kNoHalfEdge, kNoHalfEdge});
}

Pairing ChainedPairing(const TriangleMesh& mesh, FaceAdjacency& out) {
  ClearOpposites(mesh.triangles.size(), out);
  std::vector<uint32_t> head(mesh.positions.size(), kNoHalfEdge);
  std::vector<EdgeEntry> entries;
  entries.reserve(mesh.triangles.size() * 3 / 2 + 64);
  uint32_t h = 0;
  for (const Triangle& t : mesh.triangles) {
    if (HasRepeatedIndex(t)) return Pairing::kNotOrientedManifold;
    for (int i = 0; i < 3; ++i, ++h) {
      const uint32_t from = t[i].index(), to = t[i == 2 ? 0 : i + 1].index();
      const uint32_t smaller = std::min(from, to), larger = std::max(from, to);
      uint32_t e = head[smaller], steps = 0;
      while (e != kNoHalfEdge && entries[e].larger_end != larger) {
        e = entries[e].next;
        if (++steps > kLongestChain) return Pairing::kChainTooLong;
      }
      if (e == kNoHalfEdge) {
        entries.push_back({larger, head[smaller], h});
        head[smaller] = static_cast<uint32_t>(entries.size() - 1);
        continue;
      }
      const uint32_t partner = entries[e].half_edge;
      if (out.OppositeOf(partner) != kNoHalfEdge || OriginOf(mesh, partner).index() == from) {
        return Pairing::kNotOrientedManifold;
      }
      out.opposite[h / 3][i] = partner;
      out.opposite[partner / 3][partner % 3] = h;
    }
  }
  return Pairing::kOriented;
}

// Pairs the two half-edges of every edge that has just two, in opposite directions. False when another edge was seen.
bool SortedPairing(const TriangleMesh& mesh, FaceAdjacency& out) {
  ClearOpposites(mesh.triangles.size(), out);
  const std::vector<uint32_t> order = HalfEdgesByEdge(mesh);
  bool oriented = order.size() == 3 * mesh.triangles.size();
  for (size_t i = 0, end; i < order.size(); i = end) {
    const VertexId from = OriginOf(mesh, order[i]), to = TargetOf(mesh, order[i]);
    bool opposed = true;
    for (end = i + 1; end < order.size(); ++end) {
      const bool same = OriginOf(mesh, order[end]) == from && TargetOf(mesh, order[end]) == to;
      const bool reversed = OriginOf(mesh, order[end]) == to && TargetOf(mesh, order[end]) == from;
      if (!same && !reversed) break;
      opposed = reversed;
    }
    if (end - i == 1) continue;
    if (end - i > 2 || !opposed) {
      oriented = false;
      continue;
    }
    out.opposite[order[i] / 3][order[i] % 3] = order[i + 1];
    out.opposite[order[i + 1] / 3][order[i + 1] % 3] = order[i];
  }
  return oriented;
}

void FindOutgoing(const TriangleMesh& mesh, FaceAdjacency& adjacency) {
  adjacency.outgoing.assign(mesh.positions.size(), kNoHalfEdge);
  uint32_t h = 0;
  for (const Triangle& t : mesh.triangles) {
    const std::array<uint32_t, 3>& across = adjacency.opposite[h / 3];
    for (int i = 0; i < 3; ++i, ++h) {
      uint32_t& best = adjacency.outgoing[t[i].index()];
      if (best == kNoHalfEdge || (across[i] == kNoHalfEdge && adjacency.OppositeOf(best) != kNoHalfEdge)) best = h;
    }
  }
}

}  // namespace

std::vector<uint32_t> HalfEdgesByEdge(const TriangleMesh& mesh) {
  // Counting sort twice, by the larger end and then, stably, by the smaller.
  std::vector<uint32_t> source, sorted;
  source.reserve(3 * mesh.triangles.size());
  for (size_t f = 0; f < mesh.triangles.size(); ++f) {
    if (HasRepeatedIndex(mesh.triangles[f])) continue;
    for (uint32_t i = 0; i < 3; ++i) source.push_back(static_cast<uint32_t>(3 * f + i));
  }
  sorted.resize(source.size());
  for (const bool by_larger : {true, false}) {
    const auto key = [&](uint32_t h) {
      const uint32_t a = OriginOf(mesh, h).index(), b = TargetOf(mesh, h).index();
      return by_larger ? std::max(a, b) : std::min(a, b);
    };
    std::vector<uint32_t> start(mesh.positions.size() + 1, 0);
    for (const uint32_t h : source) ++start[key(h) + 1];
    for (size_t v = 1; v < start.size(); ++v) start[v] += start[v - 1];
    for (const uint32_t h : source) sorted[start[key(h)]++] = h;
    source.swap(sorted);
  }
  return source;
}

FaceAdjacency CreateAdjacency(const TriangleMesh& mesh) {
  FaceAdjacency adjacency;
  if (ChainedPairing(mesh, adjacency) != Pairing::kOriented) SortedPairing(mesh, adjacency);
  FindOutgoing(mesh, adjacency);
  return adjacency;
}

std::optional<FaceAdjacency> FindOrientedAdjacency(const TriangleMesh& mesh) {
  FaceAdjacency adjacency;
  const Pairing pairing = ChainedPairing(mesh, adjacency);
  if (pairing == Pairing::kNotOrientedManifold) return std::nullopt;
  if (pairing == Pairing::kChainTooLong && !SortedPairing(mesh, adjacency)) return std::nullopt;
  FindOutgoing(mesh, adjacency);
  return adjacency;
}

Box3 BoundingBox(const TriangleMesh& mesh, const FaceAdjacency& adjacency) {
  Box3 box;
  for (size_t v = 0; v < adjacency.outgoing.size(); ++v) {
    if (adjacency.outgoing[v] != kNoHalfEdge) box.Extend(mesh.positions[v]);
  }
  return box;
}

bool HasSingleFans(const TriangleMesh& mesh, const FaceAdjacency& adjacency) {
  // One walk from each vertex's first half-edge; together they must see every corner.
  size_t seen = 0;
  for (uint32_t v = 0; v < adjacency.outgoing.size(); ++v) VisitOutgoing(adjacency, v, [&](uint32_t) { ++seen; });
  return seen == 3 * mesh.triangles.size();
}

std::vector<std::vector<uint32_t>> FindBoundaryLoops(const FaceAdjacency& adjacency) {
  std::vector<std::vector<uint32_t>> loops;
  if (adjacency.opposite.empty()) return loops;
  std::vector<bool> visited(3 * adjacency.opposite.size(), false);
  const uint32_t* const opposite = adjacency.opposite.data()->data();
  for (uint32_t first = 0; first < visited.size(); ++first) {
    if (opposite[first] != kNoHalfEdge || visited[first]) continue;
    std::vector<uint32_t>& loop = loops.emplace_back();
    for (uint32_t h = first; !visited[h];) {
      visited[h] = true;
      loop.push_back(h);
      // Around the target, through its fan, to the other side that has no partner.
      h = NextHalfEdge(h);
      while (adjacency.OppositeOf(h) != kNoHalfEdge) h = NextHalfEdge(adjacency.OppositeOf(h));
    }
  }
  return loops;
}

// Sets of faces, each led by its first, along the order of the faces: a mesh lists neighbours near each other, so that the memory is
// gone through nearly in order. Rejected: a search from each component's first face, fewer instructions, which jumps about.
FaceComponents LabelComponents(const FaceAdjacency& adjacency) {
  FaceComponents out;
  out.label.resize(adjacency.opposite.size());
  uint32_t* const earlier = out.label.data();  // at first: a face of the same set, itself where it is the first
  for (uint32_t f = 0; f < adjacency.opposite.size(); ++f) {
    uint32_t first = f;
    earlier[f] = f;
    for (const uint32_t h : adjacency.opposite[f]) {
      if (h >= 3 * f) continue;  // of a later face, or none
      uint32_t other = FaceOfHalfEdge(h);
      while (earlier[other] != other) other = earlier[other] = earlier[earlier[other]];
      earlier[std::max(first, other)] = std::min(first, other);
      first = std::min(first, other);
    }
  }
  for (uint32_t f = 0; f < out.label.size(); ++f) earlier[f] = earlier[f] == f ? out.count++ : out.label[earlier[f]];
  return out;
}

}  // namespace meshfront
