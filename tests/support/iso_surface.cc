// The zero set of a field, by tetrahedra:
//   1. EvaluateGrid   the field at the vertices of a grid, whose cubes are cut into six tetrahedra each (Kuhn's way: equal
//                     on both sides of every cube's face)
//   2. SnapVertices   a grid vertex close to the surface, along an edge, is moved onto it
//   3. AddTetrahedron the triangles that separate the inside corners of each tetrahedron from the rest
// Rejected: moving the vertices onto the surface at the end instead of step 2; it can fold slivers over.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "core/geometry/triangle.h"
#include "tests/support/shapes.h"

namespace meshfront::testing {
namespace {

class TetrahedronMarcher {
 public:
  TetrahedronMarcher(const std::function<double(const Vec3&)>& f, const Box3& box, int cells) : f_(f) {
    EvaluateGrid(box, cells);
    ForEachTetrahedron([this](const Corners& c) { SnapVertices(c); });
    ForEachTetrahedron([this](const Corners& c) { AddTetrahedron(c); });
    for (const auto& [key, t] : whole_faces_) mesh.triangles.push_back(t);
    // A vertex named for a pair of faces that cancelled is left over, harmlessly in a set of faces but not here.
    mesh = WithoutUnreferenced(mesh);
  }
  TriangleMesh mesh;

 private:
  using Corners = std::array<uint32_t, 4>;
  // As in Clipper: the share of an edge within which a crossing takes the vertex along.
  static constexpr double kSnapShare = 0.2;

  void EvaluateGrid(const Box3& box, int cells) {
    const Vec3 size = box.max - box.min;
    const double step = std::max({size.x, size.y, size.z}) / cells;
    for (int axis = 0; axis < 3; ++axis) count_[axis] = static_cast<int>(std::ceil(size[axis] / step - 1e-9)) + 1;
    for (int k = 0; k < count_[2]; ++k) {
      for (int j = 0; j < count_[1]; ++j) {
        for (int i = 0; i < count_[0]; ++i) {
          points_.push_back(box.min + step * Vec3{double(i), double(j), double(k)});
          values_.push_back(f_(points_.back()));
        }
      }
    }
    names_.resize(points_.size());
  }

  template <class Body>
  void ForEachTetrahedron(const Body& body) const {
    // Each permutation of the axes is one path from a cube's low corner to its high corner, that is one tetrahedron.
    constexpr int kPaths[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
    const uint32_t strides[3] = {1, static_cast<uint32_t>(count_[0]), static_cast<uint32_t>(count_[0] * count_[1])};
    for (int k = 0; k + 1 < count_[2]; ++k) {
      for (int j = 0; j + 1 < count_[1]; ++j) {
        for (int i = 0; i + 1 < count_[0]; ++i) {
          const uint32_t low = i * strides[0] + j * strides[1] + k * strides[2];
          for (const auto& path : kPaths) {
            Corners corners{low};
            for (int s = 0; s < 3; ++s) corners[s + 1] = corners[s] + strides[path[s]];
            body(corners);
          }
        }
      }
    }
  }

  bool Crosses(uint32_t a, uint32_t b) const { return values_[a] * values_[b] < 0; }
  double CrossingOf(uint32_t a, uint32_t b) const {
    double low = 0, high = 1;
    for (int i = 0; i < 50; ++i) {
      const double middle = 0.5 * (low + high);
      ((f_(Lerp(points_[a], points_[b], middle)) < 0) == (values_[a] < 0) ? low : high) = middle;
    }
    return 0.5 * (low + high);
  }

  void SnapVertices(const Corners& corners) {
    for (int i = 0; i < 4; ++i) {
      for (int j = i + 1; j < 4; ++j) {
        const uint32_t a = corners[i], b = corners[j];
        if (!Crosses(a, b)) continue;
        const double s = CrossingOf(a, b);
        if (s > kSnapShare && s < 1 - kSnapShare) continue;
        const uint32_t moved = s < 0.5 ? a : b;
        points_[moved] = Lerp(points_[a], points_[b], s);
        values_[moved] = 0;
      }
    }
  }

  VertexId VertexAt(uint32_t grid) {
    if (!names_[grid].valid()) {
      names_[grid] = VertexId(mesh.positions.size());
      mesh.positions.push_back(points_[grid]);
    }
    return names_[grid];
  }
  VertexId VertexOn(uint32_t a, uint32_t b) {
    if (b < a) std::swap(a, b);
    const auto [it, added] = cuts_.try_emplace({a, b}, mesh.positions.size());
    if (added) mesh.positions.push_back(Lerp(points_[a], points_[b], CrossingOf(a, b)));
    return it->second;
  }

  // Inside corners are those with f < 0; the surface passes through those with f = 0 and the crossed edges.
  void AddTetrahedron(const Corners& corners) {
    std::vector<uint32_t> in, on, out;
    for (const uint32_t c : corners) (values_[c] < 0 ? in : values_[c] > 0 ? out : on).push_back(c);
    if (in.empty()) return;
    std::vector<VertexId> polygon;
    for (const uint32_t c : on) polygon.push_back(VertexAt(c));
    if (in.size() == 2 && out.size() == 2) {
      polygon = {VertexOn(in[0], out[0]), VertexOn(in[0], out[1]), VertexOn(in[1], out[1]), VertexOn(in[1], out[0])};
    } else {
      for (const uint32_t a : in) {
        for (const uint32_t b : out) polygon.push_back(VertexOn(a, b));
      }
    }
    AddPolygon(polygon, points_[in[0]], on.size() == 3);
  }
  // Triangles over a convex polygon, facing away from `inside`. One that is a whole face of the tetrahedron separates nothing
  // when the tetrahedron behind it is inside as well: it then comes a second time and both go.
  void AddPolygon(const std::vector<VertexId>& polygon, const Vec3& inside, bool whole_face) {
    for (size_t i = 2; i < polygon.size(); ++i) {
      Triangle t{polygon[0], polygon[i - 1], polygon[i]};
      const Vec3& a = mesh.PositionAt(t[0]);
      if (Dot(AreaVector(a, mesh.PositionAt(t[1]), mesh.PositionAt(t[2])), a - inside) < 0) std::swap(t[1], t[2]);
      if (!whole_face) {
        mesh.triangles.push_back(t);
        continue;
      }
      Triangle key = t;
      std::sort(key.begin(), key.end());
      if (const auto [it, added] = whole_faces_.try_emplace(key, t); !added) whole_faces_.erase(it);
    }
  }

  const std::function<double(const Vec3&)>& f_;
  int count_[3] = {};
  std::vector<Vec3> points_;
  std::vector<double> values_;
  std::vector<VertexId> names_;
  std::map<std::pair<uint32_t, uint32_t>, VertexId> cuts_;
  std::map<Triangle, Triangle> whole_faces_;  // by sorted corners
};

}  // namespace

TriangleMesh IsoSurface(const std::function<double(const Vec3&)>& f, const Box3& box, int cells) {
  return std::move(TetrahedronMarcher(f, box, cells).mesh);
}

}  // namespace meshfront::testing
