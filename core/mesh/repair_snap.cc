#include "core/mesh/repair_snap.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <vector>

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

bool IsSoup(const TriangleMesh& mesh) {
  if (mesh.triangles.size() < kFewestTriangles) return false;
  const std::vector<uint32_t> first = FirstAtPosition(mesh.positions);
  std::vector<std::pair<uint32_t, uint32_t>> sides;
  for (const Triangle& t : mesh.triangles) {
    for (int i = 0; i < 3; ++i) {
      const uint32_t a = first[t[i].index()], b = first[t[(i + 1) % 3].index()];
      sides.push_back({std::min(a, b), std::max(a, b)});
    }
  }
  std::sort(sides.begin(), sides.end());
  size_t lone = 0;
  for (size_t i = 0, end; i < sides.size(); i = end) {
    for (end = i + 1; end < sides.size() && sides[end] == sides[i];) ++end;
    lone += end - i == 1;
  }
  return 2 * lone >= sides.size();
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

// The used vertices in the order of a grid of the tolerance's size.
std::vector<Cell> CellsOf(const TriangleMesh& mesh, const Vec3& origin, double tolerance) {
  std::vector<bool> used(mesh.positions.size(), false);
  for (const Triangle& t : mesh.triangles) {
    for (const VertexId v : t) used[v.index()] = true;
  }
  std::vector<Cell> cells;
  for (uint32_t v = 0; v < used.size(); ++v) {
    if (!used[v]) continue;
    const Vec3 q = (mesh.positions[v] - origin) / tolerance;
    cells.push_back({int64_t(std::floor(q.x)), int64_t(std::floor(q.y)), int64_t(std::floor(q.z)), v});
  }
  std::sort(cells.begin(), cells.end(), Precedes);
  return cells;
}

// Corners in one cell are one; of each cell around, only the first is compared, so that crowds cost no more.
UnionFind Clusters(const TriangleMesh& mesh, const std::vector<Cell>& cells, double tolerance) {
  UnionFind clusters(mesh.positions.size());
  for (size_t i = 1; i < cells.size(); ++i) {
    if (cells[i].Key() == cells[i - 1].Key()) clusters.Unite(cells[i].vertex, cells[i - 1].vertex);
  }
  for (const Cell& cell : cells) {
    for (int n = 0; n < 27; ++n) {
      const Cell wanted{cell.x + n % 3 - 1, cell.y + n / 3 % 3 - 1, cell.z + n / 9 - 1, 0};
      const auto it = std::lower_bound(cells.begin(), cells.end(), wanted, Precedes);
      if (it == cells.end() || it->Key() != wanted.Key()) continue;
      if (Distance(mesh.positions[it->vertex], mesh.positions[cell.vertex]) <= tolerance)
        clusters.Unite(it->vertex, cell.vertex);
    }
  }
  return clusters;
}

}  // namespace

uint64_t SnapSoup(TriangleMesh& mesh) {
  if (!IsSoup(mesh)) return 0;
  const double tolerance = Tolerance(mesh);
  const Box3 box = BoundingBox(mesh);
  if (!(tolerance > 0) || !(box.Diagonal() / tolerance < 1e15)) return 0;
  const std::vector<Cell> cells = CellsOf(mesh, box.min, tolerance);
  UnionFind clusters = Clusters(mesh, cells, tolerance);
  uint64_t moved = 0;
  for (const Cell& cell : cells) {
    const Vec3& to = mesh.positions[clusters.Find(cell.vertex)];
    if (mesh.positions[cell.vertex] != to) mesh.positions[cell.vertex] = to, ++moved;
  }
  return moved;
}

}  // namespace meshfront
