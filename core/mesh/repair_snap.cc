#include "core/mesh/repair_snap.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>
#include <vector>

#include "absl/functional/function_ref.h"
#include "core/mesh/adjacency.h"
#include "core/mesh/tolerances.h"
#include "core/mesh/union_find.h"

namespace meshfront {
namespace {

constexpr size_t kFewestTriangles = 4;  // fewer are no soup

// For each vertex the first at the same position.
std::vector<uint32_t> FirstAtPosition(const std::vector<Vec3>& positions) {
  std::vector<uint32_t> order(positions.size()), first(positions.size());
  for (uint32_t v = 0; v < order.size(); ++v) order[v] = first[v] = v;
  std::erase_if(order, [&](uint32_t v) { return !IsFinite(positions[v]); });
  const auto key = [&](uint32_t v) { return std::tie(positions[v].x, positions[v].y, positions[v].z); };
  std::sort(order.begin(), order.end(),
            [&](uint32_t a, uint32_t b) { return key(a) != key(b) ? key(a) < key(b) : a < b; });
  for (size_t i = 1; i < order.size(); ++i) {
    if (positions[order[i]] == positions[order[i - 1]]) first[order[i]] = first[order[i - 1]];
  }
  return first;
}

// The sides that no other triangle has, by position.
struct LoneSides {
  std::vector<uint32_t> ends;  // two each: vertices
  size_t of = 0;               // sides of all triangles
};
LoneSides FindLoneSides(const TriangleMesh& mesh) {
  struct Side {
    uint32_t a, b;  // the first vertices at its ends' positions
    uint32_t half_edge;
    auto Ends() const { return std::tie(a, b); }
  };
  const std::vector<uint32_t> first = FirstAtPosition(mesh.positions);
  std::vector<Side> sides;
  sides.reserve(3 * mesh.triangles.size());
  for (uint32_t h = 0; h < 3 * mesh.triangles.size(); ++h) {
    const uint32_t a = first[OriginOf(mesh, h).index()], b = first[TargetOf(mesh, h).index()];
    sides.push_back({std::min(a, b), std::max(a, b), h});
  }
  std::sort(sides.begin(), sides.end(), [](const Side& s, const Side& t) {
    return s.Ends() != t.Ends() ? s.Ends() < t.Ends() : s.half_edge < t.half_edge;
  });
  LoneSides lone;
  lone.of = sides.size();
  for (size_t i = 0, end; i < sides.size(); i = end) {
    for (end = i + 1; end < sides.size() && sides[end].Ends() == sides[i].Ends();) ++end;
    if (end - i > 1) continue;
    lone.ends.push_back(OriginOf(mesh, sides[i].half_edge).index());
    lone.ends.push_back(TargetOf(mesh, sides[i].half_edge).index());
  }
  return lone;
}

bool IsSoup(const TriangleMesh& mesh) {
  return mesh.triangles.size() >= kFewestTriangles && FindLoneSides(mesh).ends.size() >= 3 * mesh.triangles.size();
}

double Tolerance(const TriangleMesh& mesh) {
  std::vector<double> lengths;
  for (const Triangle& t : mesh.triangles) {
    for (int i = 0; i < 3; ++i) {
      const double length = Distance(mesh.PositionAt(t[i]), mesh.PositionAt(t[(i + 1) % 3]));
      if (length > 0) lengths.push_back(length);
    }
  }
  if (lengths.empty()) return 0;
  std::nth_element(lengths.begin(), lengths.begin() + lengths.size() / 2, lengths.end());
  const double median = lengths[lengths.size() / 2];
  return std::min(kSnapToMedianSide * median, kSnapToShortestSide * *std::min_element(lengths.begin(), lengths.end()));
}

struct Cell {
  int64_t x, y, z;
  uint32_t vertex;
  auto Key() const { return std::tie(x, y, z); }
};

bool Precedes(const Cell& a, const Cell& b) { return a.Key() != b.Key() ? a.Key() < b.Key() : a.vertex < b.vertex; }

// The vertices in the order of a grid of the tolerance's size.
std::vector<Cell> CellsOf(const TriangleMesh& mesh, const std::vector<uint32_t>& vertices, const Vec3& origin,
                          double tolerance) {
  std::vector<Cell> cells;
  cells.reserve(vertices.size());
  for (const uint32_t v : vertices) {
    const Vec3 q = (mesh.positions[v] - origin) / tolerance;
    cells.push_back({int64_t(std::floor(q.x)), int64_t(std::floor(q.y)), int64_t(std::floor(q.z)), v});
  }
  std::sort(cells.begin(), cells.end(), Precedes);
  return cells;
}

std::vector<uint32_t> UsedVertices(const TriangleMesh& mesh) {
  std::vector<bool> used(mesh.positions.size(), false);
  for (const Triangle& t : mesh.triangles) {
    for (const VertexId v : t) used[v.index()] = true;
  }
  std::vector<uint32_t> vertices;
  for (uint32_t v = 0; v < used.size(); ++v) {
    if (used[v]) vertices.push_back(v);
  }
  return vertices;
}

using Meets = absl::FunctionRef<bool(uint32_t v, uint32_t u)>;

// Of each cell its neighbours in order that meet `in_cell`, and of each cell around the first where they meet `across`, so that crowds
// cost no more.
UnionFind Clusters(const TriangleMesh& mesh, const std::vector<Cell>& cells, Meets in_cell, Meets across) {
  UnionFind clusters(mesh.positions.size());
  for (size_t i = 1; i < cells.size(); ++i) {
    if (cells[i].Key() == cells[i - 1].Key() && in_cell(cells[i].vertex, cells[i - 1].vertex))
      clusters.Unite(cells[i].vertex, cells[i - 1].vertex);
  }
  for (const Cell& cell : cells) {
    for (int n = 0; n < 27; ++n) {
      const Cell wanted{cell.x + n % 3 - 1, cell.y + n / 3 % 3 - 1, cell.z + n / 9 - 1, 0};
      const auto it = std::lower_bound(cells.begin(), cells.end(), wanted, Precedes);
      if (it == cells.end() || it->Key() != wanted.Key()) continue;
      if (across(it->vertex, cell.vertex)) clusters.Unite(it->vertex, cell.vertex);
    }
  }
  return clusters;
}

// Those that are not where the first of their cluster is, with that.
std::vector<std::pair<uint32_t, uint32_t>> MovesOf(const TriangleMesh& mesh, const std::vector<Cell>& cells,
                                                   UnionFind clusters) {
  std::vector<std::pair<uint32_t, uint32_t>> moves;
  for (const Cell& cell : cells) {
    const uint32_t to = clusters.Find(cell.vertex);
    if (mesh.positions[cell.vertex] != mesh.positions[to]) moves.push_back({cell.vertex, to});
  }
  return moves;
}

uint64_t Move(TriangleMesh& mesh, const std::vector<std::pair<uint32_t, uint32_t>>& moves) {
  for (const auto& [v, to] : moves) mesh.positions[v] = mesh.positions[to];
  return moves.size();
}

// At each of the vertices, squared; infinite elsewhere.
std::vector<double> ShortestSidesAt(const TriangleMesh& mesh, const std::vector<uint32_t>& vertices) {
  std::vector<bool> wanted(mesh.positions.size(), false);
  for (const uint32_t v : vertices) wanted[v] = true;
  std::vector<double> shortest2(mesh.positions.size(), std::numeric_limits<double>::infinity());
  for (uint32_t h = 0; h < 3 * mesh.triangles.size(); ++h) {
    const uint32_t a = OriginOf(mesh, h).index(), b = TargetOf(mesh, h).index();
    if (!wanted[a] && !wanted[b]) continue;
    const double side2 = SquaredDistance(mesh.positions[a], mesh.positions[b]);
    if (!(side2 > 0)) continue;
    shortest2[a] = std::min(shortest2[a], side2), shortest2[b] = std::min(shortest2[b], side2);
  }
  return shortest2;
}

std::vector<std::pair<uint32_t, uint32_t>> RimSnaps(const TriangleMesh& mesh, std::vector<uint32_t> vertices) {
  std::erase_if(vertices, [&](uint32_t v) { return !IsFinite(mesh.positions[v]); });
  std::sort(vertices.begin(), vertices.end());
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  const Box3 box = BoundingBox(mesh);
  const double tolerance = kSnapRimsToDiagonal * box.Diagonal();
  if (vertices.empty() || !(tolerance > 0) || !std::isfinite(tolerance)) return {};
  const std::vector<double> shortest2 = ShortestSidesAt(mesh, vertices);
  const std::vector<Cell> cells = CellsOf(mesh, vertices, box.min, tolerance);
  const auto meet = [&](uint32_t v, uint32_t u) {
    const double side2 = std::min(shortest2[v], shortest2[u]);
    return SquaredDistance(mesh.positions[v], mesh.positions[u]) <=
           std::min(tolerance * tolerance, kSnapRimsToSide * kSnapRimsToSide * side2);
  };
  return MovesOf(mesh, cells, Clusters(mesh, cells, meet, meet));
}

}  // namespace

uint64_t SnapSoup(TriangleMesh& mesh) {
  if (!IsSoup(mesh)) return 0;
  const double tolerance = Tolerance(mesh);
  const Box3 box = BoundingBox(mesh);
  if (!(tolerance > 0) || !(box.Diagonal() / tolerance < 1e15)) return 0;
  const std::vector<Cell> cells = CellsOf(mesh, UsedVertices(mesh), box.min, tolerance);
  const auto always = [](uint32_t, uint32_t) { return true; };
  const auto meet = [&](uint32_t v, uint32_t u) { return Distance(mesh.positions[v], mesh.positions[u]) <= tolerance; };
  return Move(mesh, MovesOf(mesh, cells, Clusters(mesh, cells, always, meet)));
}

uint64_t SnapRims(TriangleMesh& mesh) { return Move(mesh, RimSnaps(mesh, FindLoneSides(mesh).ends)); }

bool DoRimsAlmostMeet(const TriangleMesh& mesh, const std::vector<uint32_t>& rim_vertices) {
  return !rim_vertices.empty() && !RimSnaps(mesh, rim_vertices).empty();
}

}  // namespace meshfront
