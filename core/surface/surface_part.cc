// MeshSurface::CreatePart: 1. the chosen faces and what lies across their sides; 2. one vertex for each fan of them, so that parts which
// touch in a vertex come apart (NameFans), those that stand for a vertex of the whole first; 3. normals and curvatures of the whole;
// 4. the border: sides across which the whole goes on, and edges of the whole that join two of its vertices on the other side.
#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "core/surface/mesh_surface.h"

namespace meshfront {
namespace {

class PartMaker {
 public:
  PartMaker(const MeshSurface& whole, const std::vector<bool>& chosen) : whole_(whole), chosen_(chosen) {
    part_of_.resize(chosen.size(), kNoHalfEdge);
    for (uint32_t f = 0; f < chosen.size(); ++f) {
      if (!chosen[f]) continue;
      part_of_[f] = static_cast<uint32_t>(faces.size());
      faces.push_back(f);
      mesh.triangles.push_back(whole.mesh().triangles[f]);
    }
    adjacency.opposite.resize(faces.size());
    whole_opposite.resize(faces.size());
    is_border.resize(3 * faces.size());
    for (uint32_t h = 0; h < 3 * faces.size(); ++h) LookAcross(h);
    NameFans();
    FindBorder();
  }

  TriangleMesh mesh;
  FaceAdjacency adjacency;
  std::vector<std::array<uint32_t, 3>> whole_opposite;
  std::vector<uint32_t> faces, vertices, originals;  // of the whole; and within the part
  std::vector<bool> is_border;                       // of each half-edge
  std::vector<uint32_t> border_vertices;
  std::vector<std::pair<uint32_t, uint32_t>> taken;

 private:
  uint32_t InWhole(uint32_t h) const { return 3 * faces[h / 3] + h % 3; }
  uint32_t InPart(uint32_t h) const {
    return h == kNoHalfEdge || !chosen_[h / 3] ? kNoHalfEdge : 3 * part_of_[h / 3] + h % 3;
  }
  uint32_t OriginalIn(const TriangleMesh& triangles, uint32_t h) const {
    return whole_.OriginalOf(OriginOf(triangles, h));
  }
  void LookAcross(uint32_t h);
  void NameFans();
  void FindBorder();
  void FindTaken();

  const MeshSurface& whole_;
  const std::vector<bool>& chosen_;
  std::vector<uint32_t> part_of_;  // of each face of the whole, its number in the part
  std::vector<uint32_t> rank_of_;  // of each vertex of the whole before its cut, its number in the part
};

void PartMaker::LookAcross(uint32_t h) {
  const uint32_t smooth = whole_.adjacency().OppositeOf(InWhole(h)), sharp = whole_.AcrossCrease(InWhole(h));
  const uint32_t across = smooth != kNoHalfEdge ? smooth : sharp;
  adjacency.opposite[h / 3][h % 3] = InPart(smooth);
  whole_opposite[h / 3][h % 3] = InPart(across);
  is_border[h] = across != kNoHalfEdge && !chosen_[across / 3];
}

void PartMaker::NameFans() {
  const auto half_edges = static_cast<uint32_t>(3 * faces.size());
  std::vector<uint32_t> used;
  for (uint32_t h = 0; h < half_edges; ++h) used.push_back(OriginalIn(mesh, h));
  std::sort(used.begin(), used.end());
  used.erase(std::unique(used.begin(), used.end()), used.end());
  rank_of_.assign(whole_.mesh().positions.size(), kNoHalfEdge);
  for (uint32_t i = 0; i < used.size(); ++i) rank_of_[used[i]] = i;
  vertices.assign(used.size(), kNoHalfEdge);
  originals.resize(used.size());
  adjacency.outgoing.resize(used.size());
  std::vector<bool> named(half_edges, false);
  for (uint32_t h = 0; h < half_edges; ++h) {
    if (named[h]) continue;
    uint32_t first = h;  // of the fan: one on the rim, where it has one
    for (uint32_t across; (across = adjacency.OppositeOf(first)) != kNoHalfEdge;) {
      first = NextHalfEdge(across);
      if (first == h) break;
    }
    const uint32_t of_whole = OriginOf(mesh, h).index(), rank = rank_of_[whole_.OriginalOf(VertexId(of_whole))];
    uint32_t name = rank;
    if (vertices[rank] != kNoHalfEdge) {
      name = static_cast<uint32_t>(vertices.size());
      vertices.emplace_back(), originals.emplace_back(), adjacency.outgoing.emplace_back();
    }
    vertices[name] = of_whole, originals[name] = rank, adjacency.outgoing[name] = first;
    for (uint32_t g = first; g != kNoHalfEdge && !named[g]; g = adjacency.NextAroundOrigin(g)) {
      named[g] = true;
      mesh.triangles[g / 3][g % 3] = VertexId(name);
    }
  }
  for (const uint32_t v : vertices) mesh.positions.push_back(whole_.mesh().positions[v]);
}

void PartMaker::FindBorder() {
  for (uint32_t h = 0; h < is_border.size(); ++h) {
    if (!is_border[h]) continue;
    border_vertices.push_back(originals[OriginOf(mesh, h).index()]);
    border_vertices.push_back(originals[TargetOf(mesh, h).index()]);
  }
  std::sort(border_vertices.begin(), border_vertices.end());
  border_vertices.erase(std::unique(border_vertices.begin(), border_vertices.end()), border_vertices.end());
  FindTaken();
}

void PartMaker::FindTaken() {
  std::vector<bool> on_border(vertices.size(), false);
  for (const uint32_t v : border_vertices) on_border[v] = true;
  const TriangleMesh& all = whole_.mesh();
  for (uint32_t h = 0; h < 3 * all.triangles.size(); ++h) {
    if (chosen_[h / 3]) continue;
    const uint32_t a = rank_of_[OriginalIn(all, h)], b = rank_of_[OriginalIn(all, NextHalfEdge(h))];
    if (a == kNoHalfEdge || b == kNoHalfEdge || !on_border[a] || !on_border[b]) continue;
    const uint32_t smooth = whole_.adjacency().OppositeOf(h);
    const uint32_t across = smooth != kNoHalfEdge ? smooth : whole_.AcrossCrease(h);
    if (across == kNoHalfEdge || !chosen_[across / 3]) taken.push_back(std::minmax(a, b));
  }
  std::sort(taken.begin(), taken.end());
  taken.erase(std::unique(taken.begin(), taken.end()), taken.end());
}

}  // namespace

std::unique_ptr<MeshSurface> MeshSurface::CreatePart(std::shared_ptr<const MeshSurface> whole,
                                                     const std::vector<bool>& chosen) {
  PartMaker maker(*whole, chosen);
  auto part = std::unique_ptr<MeshSurface>(new MeshSurface(std::move(maker.mesh), std::move(maker.adjacency)));
  for (size_t v = 0; v < maker.vertices.size(); ++v) {
    part->normals_[v] = whole->normals_[maker.vertices[v]];
    part->curvatures_[v] = whole->curvatures_[maker.vertices[v]];
  }
  part->has_curvature_ = whole->has_curvature_;
  part->originals_ = std::move(maker.originals);
  part->whole_opposite_ = std::move(maker.whole_opposite);
  part->whole_diagonals_.resize(part->component_count());
  for (size_t f = 0; f < maker.faces.size(); ++f) {
    const uint32_t component = whole->components_.label[maker.faces[f]];
    part->whole_diagonals_[part->components_.label[f]] = whole->whole_diagonals()[component];
  }
  part->is_border_ = std::move(maker.is_border);
  part->border_vertices_ = std::move(maker.border_vertices);
  part->taken_ = std::move(maker.taken);
  part->vertices_of_whole_ = std::move(maker.vertices);
  part->whole_ = std::move(whole);
  return part;
}

void MeshSurface::TakeBorderFrom(const MeshSurface& other) {
  is_border_ = other.is_border_;
  border_vertices_ = other.border_vertices_;
  taken_ = other.taken_;
  whole_ = other.whole_;
  vertices_of_whole_.clear();
  for (uint32_t v = 0; v < mesh_.positions.size(); ++v)
    vertices_of_whole_.push_back(other.vertices_of_whole_[OriginalOf(VertexId(v))]);
  whole_diagonals_.resize(component_count());
  for (uint32_t f = 0; f < mesh_.triangles.size(); ++f)
    whole_diagonals_[components_.label[f]] = other.whole_diagonals_[other.components_.label[f]];
}

absl::StatusOr<std::vector<double>> MeshSurface::SheetDistancesInWhole(absl::Span<const double> limits,
                                                                       const Context& context) const {
  std::vector<double> of_whole(whole_->mesh_.positions.size(), 0.0);
  for (size_t v = 0; v < limits.size(); ++v) {
    double& limit = of_whole[vertices_of_whole_[v]];
    limit = std::max(limit, limits[v]);
  }
  absl::StatusOr<std::vector<double>> distances = whole_->SheetDistances(of_whole, context);
  if (!distances.ok()) return distances;
  std::vector<double> own;
  own.reserve(limits.size());
  for (size_t v = 0; v < limits.size(); ++v) own.push_back((*distances)[vertices_of_whole_[v]]);
  return own;
}

}  // namespace meshfront
