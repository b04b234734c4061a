// Making an oriented manifold:
//
// 1. PairByIndex: two faces at an edge are paired; more than two by their angles around it, what is left becomes rim.
// 2. Orient: each component is walked; the minority of its faces is reversed. Pairs that contradict the walk belong to
//    a component that can't be oriented (Möbius, Klein) and are cut: they form curves that end nowhere inside.
// 3. Weld: rims that run in opposite directions between the same positions are paired.
// 4. AssignVertices: the corners that pairs connect are one fan and get one vertex; a vertex with several fans is
//    copied, vertices in one fan become one.
// 5. Two edges may now run between the same two vertices (a sheet that touches itself along an edge and is connected
//    around both ends). Joins of step 3 there are undone; where there are none, faces beyond the first pair are
//    dropped.
// Rejected: welding by position first; it makes open meshes that touch themselves non-manifold, to be cut apart again.
#include "core/mesh/repair_pairing.h"

#include <algorithm>
#include <tuple>

#include "core/mesh/adjacency.h"
#include "core/mesh/repair_around_edge.h"
#include "core/mesh/union_find.h"

namespace meshfront {
namespace {

constexpr int kWeldUndoRounds = 4;  // then all joins are undone

struct RimEdge {
  uint32_t low, high;  // representatives of the ends' positions
  bool forward;        // from low to high
  uint32_t half_edge;
  bool SameEnds(const RimEdge& o) const { return low == o.low && high == o.high; }
};

bool PositionLess(const Vec3& a, const Vec3& b) { return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z); }

// The rims in groups of the same two end positions. −0 and 0 are the same.
std::vector<RimEdge> RimsByPosition(const TriangleMesh& mesh, const std::vector<uint32_t>& rims) {
  std::vector<uint32_t> vertices;
  for (const uint32_t h : rims) {
    vertices.push_back(OriginOf(mesh, h).index());
    vertices.push_back(TargetOf(mesh, h).index());
  }
  std::sort(vertices.begin(), vertices.end());
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  std::stable_sort(vertices.begin(), vertices.end(),
                   [&](uint32_t a, uint32_t b) { return PositionLess(mesh.positions[a], mesh.positions[b]); });
  std::vector<uint32_t> representative(mesh.positions.size(), kNoHalfEdge);
  for (size_t i = 0; i < vertices.size(); ++i) {
    const bool same = i > 0 && mesh.positions[vertices[i]] == mesh.positions[vertices[i - 1]];
    representative[vertices[i]] = same ? representative[vertices[i - 1]] : vertices[i];
  }
  std::vector<RimEdge> edges;
  for (const uint32_t h : rims) {
    const uint32_t from = representative[OriginOf(mesh, h).index()], to = representative[TargetOf(mesh, h).index()];
    if (from != to) edges.push_back({std::min(from, to), std::max(from, to), from < to, h});
  }
  std::sort(edges.begin(), edges.end(), [](const RimEdge& a, const RimEdge& b) {
    return std::tie(a.low, a.high, a.half_edge) < std::tie(b.low, b.high, b.half_edge);
  });
  return edges;
}

std::pair<VertexId, VertexId> EndsOf(const TriangleMesh& mesh, uint32_t h) {
  const VertexId a = OriginOf(mesh, h), b = TargetOf(mesh, h);
  return a < b ? std::pair(a, b) : std::pair(b, a);
}

const Vec3& ApexOf(const TriangleMesh& mesh, uint32_t h) {
  return mesh.PositionAt(OriginOf(mesh, PreviousHalfEdge(h)));
}

class ManifoldMaker {
 public:
  explicit ManifoldMaker(TriangleMesh& mesh) : mesh_(mesh), partner_(3 * mesh.triangles.size(), kNoHalfEdge) {}

  PairingChanges Make() {
    PairByIndex();
    Orient();
    Weld();
    for (int round = 0;; ++round) {
      TriangleMesh candidate = AssignVertices();
      const std::vector<uint32_t> conflicts = ConflictsOf(candidate);
      if (conflicts.empty()) {
        mesh_ = std::move(candidate);
        return changes_;
      }
      if (!UndoWelds(candidate, conflicts, round >= kWeldUndoRounds)) DropFaces(candidate, conflicts);
    }
  }

 private:
  void Pair(uint32_t h, uint32_t g) { partner_[h] = g, partner_[g] = h; }
  void Unpair(uint32_t h) {
    if (partner_[h] == kNoHalfEdge) return;
    partner_[partner_[h]] = kNoHalfEdge;
    partner_[h] = kNoHalfEdge;
  }
  bool SameDirection(uint32_t h, uint32_t g) const {
    return OriginOf(mesh_, h) == OriginOf(mesh_, g) && TargetOf(mesh_, h) == TargetOf(mesh_, g);
  }
  bool SameEdge(uint32_t h, uint32_t g) const {
    return SameDirection(h, g) ||
           (OriginOf(mesh_, h) == TargetOf(mesh_, g) && TargetOf(mesh_, h) == OriginOf(mesh_, g));
  }

  void PairByIndex() {
    const std::vector<uint32_t> order = HalfEdgesByEdge(mesh_);
    for (size_t i = 0, end; i < order.size(); i = end) {
      for (end = i + 1; end < order.size() && SameEdge(order[i], order[end]);) ++end;
      if (end - i == 2) Pair(order[i], order[i + 1]);
      if (end - i <= 2) continue;
      ++changes_.split_edges;
      std::vector<FaceAtEdge> faces;
      for (size_t k = i; k < end; ++k) {
        faces.push_back({order[k], SameDirection(order[i], order[k]), ApexOf(mesh_, order[k])});
      }
      const Vec3 &a = mesh_.PositionAt(OriginOf(mesh_, order[i])), &b = mesh_.PositionAt(TargetOf(mesh_, order[i]));
      for (const auto& [h, g] : PairFacesAround(a, b, std::move(faces), false)) Pair(h, g);
    }
  }

  void Orient() {
    std::vector<bool> seen(mesh_.triangles.size(), false), reversed(mesh_.triangles.size(), false);
    for (uint32_t seed = 0; seed < seen.size(); ++seed) {
      if (seen[seed]) continue;
      const std::vector<uint32_t> component = WalkComponent(seed, seen, reversed);
      size_t reversals = 0;
      for (const uint32_t f : component) reversals += reversed[f];
      if (2 * reversals > component.size()) {
        for (const uint32_t f : component) reversed[f] = !reversed[f];
        reversals = component.size() - reversals;
      }
      changes_.reversed_faces += reversals;
      CutContradictions(component, reversed);
    }
    if (changes_.reversed_faces > 0) Reverse(reversed);
  }

  // All faces that pairs connect with the seed. Sides that agree already are crossed first, so that as few faces as
  // possible are reversed and a component that can't be oriented is cut where its file is inconsistent.
  std::vector<uint32_t> WalkComponent(uint32_t seed, std::vector<bool>& seen, std::vector<bool>& reversed) const {
    std::vector<uint32_t> component = {seed}, disagreeing;  // queues that are kept; faces and half-edges
    seen[seed] = true;
    for (size_t k = 0, d = 0; k < component.size() || d < disagreeing.size();) {
      if (k == component.size()) {
        const uint32_t h = disagreeing[d++], neighbour = FaceOfHalfEdge(partner_[h]);
        if (seen[neighbour]) continue;
        seen[neighbour] = true;
        reversed[neighbour] = !reversed[FaceOfHalfEdge(h)];
        component.push_back(neighbour);
        continue;
      }
      const uint32_t f = component[k++];
      for (uint32_t h = 3 * f; h < 3 * f + 3; ++h) {
        const uint32_t g = partner_[h];
        if (g == kNoHalfEdge || seen[FaceOfHalfEdge(g)]) continue;
        if (SameDirection(h, g)) {
          disagreeing.push_back(h);
          continue;
        }
        seen[FaceOfHalfEdge(g)] = true;
        reversed[FaceOfHalfEdge(g)] = reversed[f];
        component.push_back(FaceOfHalfEdge(g));
      }
    }
    return component;
  }

  void CutContradictions(const std::vector<uint32_t>& component, const std::vector<bool>& reversed) {
    for (const uint32_t f : component) {
      for (uint32_t h = 3 * f; h < 3 * f + 3; ++h) {
        const uint32_t g = partner_[h];
        if (g == kNoHalfEdge || (reversed[f] != reversed[FaceOfHalfEdge(g)]) == SameDirection(h, g)) continue;
        Unpair(h);
        ++changes_.cut_edges;
      }
    }
  }

  // Corners 1 and 2 change places, sides 0 and 2 with them.
  void Reverse(const std::vector<bool>& reversed) {
    const auto moved = [&](uint32_t h) { return reversed[h / 3] ? 3 * (h / 3) + 2 - h % 3 : h; };
    std::vector<uint32_t> partner(partner_.size(), kNoHalfEdge);
    for (uint32_t h = 0; h < partner_.size(); ++h) {
      if (partner_[h] != kNoHalfEdge) partner[moved(h)] = moved(partner_[h]);
    }
    partner_.swap(partner);
    for (uint32_t f = 0; f < reversed.size(); ++f) {
      if (reversed[f]) ReverseFace(mesh_, f);
    }
  }

  void Weld() {
    std::vector<uint32_t> rims;
    for (uint32_t h = 0; h < partner_.size(); ++h) {
      if (partner_[h] == kNoHalfEdge) rims.push_back(h);
    }
    const std::vector<RimEdge> edges = RimsByPosition(mesh_, rims);
    for (size_t i = 0, end; i < edges.size(); i = end) {
      for (end = i + 1; end < edges.size() && edges[i].SameEnds(edges[end]);) ++end;
      if (end - i < 2) continue;
      std::vector<FaceAtEdge> faces;
      for (size_t k = i; k < end; ++k) {
        faces.push_back({edges[k].half_edge, edges[k].forward, ApexOf(mesh_, edges[k].half_edge)});
      }
      for (const auto& [h, g] :
           PairFacesAround(mesh_.positions[edges[i].low], mesh_.positions[edges[i].high], std::move(faces), true)) {
        Pair(h, g);
        welds_.push_back(h);
      }
    }
  }

  // A mesh of the same triangles with one vertex for each fan. First come, first served: the first fan at a vertex
  // keeps it.
  TriangleMesh AssignVertices() {
    UnionFind corners(partner_.size());
    for (uint32_t h = 0; h < partner_.size(); ++h) {
      const uint32_t g = partner_[h];
      if (g == kNoHalfEdge || g < h) continue;
      corners.Unite(h, NextHalfEdge(g));
      corners.Unite(NextHalfEdge(h), g);
    }
    std::vector<uint32_t> vertex_of(partner_.size(), kNoHalfEdge);  // by a fan's first corner
    std::vector<bool> taken(mesh_.positions.size(), false), used(mesh_.positions.size(), false);
    for (uint32_t c = 0; c < partner_.size(); ++c) {
      const uint32_t fan = corners.Find(c), v = OriginOf(mesh_, c).index();
      used[v] = true;
      if (vertex_of[fan] == kNoHalfEdge && !taken[v]) vertex_of[fan] = v, taken[v] = true;
    }
    TriangleMesh out = mesh_;
    changes_.split_vertices = 0;
    for (uint32_t c = 0; c < partner_.size(); ++c) {
      uint32_t& v = vertex_of[corners.Find(c)];
      if (v == kNoHalfEdge) {
        v = static_cast<uint32_t>(out.positions.size());
        const uint32_t original = OriginOf(mesh_, c).index();
        out.positions.push_back(mesh_.positions[original]);
        if (mesh_.normals.size() == mesh_.positions.size()) out.normals.push_back(mesh_.normals[original]);
        ++changes_.split_vertices;
      }
      out.triangles[c / 3][c % 3] = VertexId(v);
    }
    changes_.welded_vertices =
        uint64_t(std::count(used.begin(), used.end(), true) - std::count(taken.begin(), taken.end(), true));
    return out;
  }

  // The half-edges of edges that are not one pair in opposite directions or a rim.
  static std::vector<uint32_t> ConflictsOf(const TriangleMesh& mesh) {
    std::vector<uint32_t> conflicts;
    if (FindOrientedAdjacency(mesh)) return conflicts;
    const std::vector<uint32_t> order = HalfEdgesByEdge(mesh);
    for (size_t i = 0, end; i < order.size(); i = end) {
      for (end = i + 1; end < order.size() && EndsOf(mesh, order[i]) == EndsOf(mesh, order[end]);) ++end;
      const bool same = end - i == 2 && OriginOf(mesh, order[i]) == OriginOf(mesh, order[i + 1]);
      if (end - i > 2 || same) conflicts.insert(conflicts.end(), order.begin() + i, order.begin() + end);
    }
    return conflicts;
  }

  // Undoes the joins at the vertices of the conflicts. False when there was none.
  bool UndoWelds(const TriangleMesh& candidate, const std::vector<uint32_t>& conflicts, bool all) {
    std::vector<bool> concerned(candidate.positions.size(), all);
    for (const uint32_t h : conflicts) {
      concerned[OriginOf(candidate, h).index()] = concerned[TargetOf(candidate, h).index()] = true;
    }
    const auto undone = std::remove_if(welds_.begin(), welds_.end(), [&](uint32_t h) {
      if (!concerned[OriginOf(candidate, h).index()] && !concerned[TargetOf(candidate, h).index()]) return false;
      Unpair(h);
      return true;
    });
    const bool any = undone != welds_.end();
    welds_.erase(undone, welds_.end());
    return any;
  }

  // Of each conflict's edge the first pair (or else the first face) stays.
  void DropFaces(const TriangleMesh& candidate, const std::vector<uint32_t>& conflicts) {
    std::vector<bool> dropped(mesh_.triangles.size(), false);
    for (size_t i = 0, end; i < conflicts.size(); i = end) {
      for (end = i + 1; end < conflicts.size() && EndsOf(candidate, conflicts[i]) == EndsOf(candidate, conflicts[end]);)
        ++end;
      uint32_t kept = conflicts[i];
      for (size_t k = end; k-- > i;) {
        if (partner_[conflicts[k]] != kNoHalfEdge) kept = conflicts[k];
      }
      for (size_t k = i; k < end; ++k) {
        if (conflicts[k] != kept && conflicts[k] != partner_[kept]) dropped[FaceOfHalfEdge(conflicts[k])] = true;
      }
    }
    Remove(dropped);
  }

  void Remove(const std::vector<bool>& dropped) {
    std::vector<uint32_t> new_face(dropped.size(), kNoHalfEdge);
    uint32_t count = 0;
    for (uint32_t f = 0; f < dropped.size(); ++f) {
      if (!dropped[f]) new_face[f] = count++;
    }
    changes_.dropped_faces += dropped.size() - count;
    std::vector<uint32_t> partner(3 * size_t{count}, kNoHalfEdge);
    for (uint32_t h = 0; h < partner_.size(); ++h) {
      const uint32_t g = partner_[h];
      if (dropped[h / 3] || g == kNoHalfEdge || dropped[g / 3]) continue;
      partner[3 * new_face[h / 3] + h % 3] = 3 * new_face[g / 3] + g % 3;
    }
    DropTriangles(mesh_, dropped);
    partner_.swap(partner);
  }

  TriangleMesh& mesh_;
  std::vector<uint32_t> partner_;  // by half-edge; may run in the same direction until Orient
  std::vector<uint32_t> welds_;    // one half-edge of each pair that Weld made
  PairingChanges changes_;
};

}  // namespace

PairingChanges MakeOrientedManifold(TriangleMesh& mesh) { return ManifoldMaker(mesh).Make(); }

bool HasCoincidentRims(const TriangleMesh& mesh, const std::vector<uint32_t>& rim_half_edges) {
  const std::vector<RimEdge> edges = RimsByPosition(mesh, rim_half_edges);
  for (size_t i = 1, start = 0; i < edges.size(); ++i) {
    if (!edges[start].SameEnds(edges[i])) start = i;
    if (edges[start].forward != edges[i].forward) return true;
  }
  return false;
}

}  // namespace meshfront
