// Solids with flat faces and sharp edges: the boundary of a set of grid cells, or an open mesh with a copy of itself below.
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>
#include <vector>

#include "core/mesh/adjacency.h"
#include "tests/support/shapes.h"

namespace meshfront::testing {
namespace {

constexpr double kPi = std::numbers::pi;

Vec3 OnCircle(double angle) { return {std::cos(angle), std::sin(angle), 0}; }

// A fan all around its first point.
TriangleMesh ClosedFan(std::vector<Vec3> points) {
  const auto last = static_cast<uint32_t>(points.size() - 1);
  TriangleMesh mesh = Fan(points);
  mesh.triangles.push_back({VertexId(0), VertexId(last), VertexId(1)});
  return mesh;
}

void AddSquare(TriangleMesh& mesh, const std::array<VertexId, 4>& v) {
  mesh.triangles.push_back({v[0], v[1], v[2]});
  mesh.triangles.push_back({v[0], v[2], v[3]});
}

// Squares between planes of a grid with n steps in a cell, their corners shared.
class CellFaces {
 public:
  explicit CellFaces(int n) : n_(n) {}
  // The face of a cell across `axis`, seen from outside.
  void AddFace(const std::array<int, 3>& cell, int axis, bool far_side) {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    const auto corner = [&](int i, int j) {
      std::array<int, 3> at{n_ * cell[0], n_ * cell[1], n_ * cell[2]};
      at[axis] += far_side ? n_ : 0;
      at[u] += i, at[v] += j;
      return VertexAt(at);
    };
    for (int j = 0; j < n_; ++j) {
      for (int i = 0; i < n_; ++i) {
        std::array<VertexId, 4> square{corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)};
        if (!far_side) std::swap(square[1], square[3]);
        AddSquare(mesh, square);
      }
    }
  }
  TriangleMesh mesh;

 private:
  VertexId VertexAt(const std::array<int, 3>& at) {
    const auto [found, is_new] = vertices_.try_emplace(at, mesh.positions.size());
    const double step = 1.0 / n_;
    if (is_new) mesh.positions.push_back({step * at[0], step * at[1], step * at[2]});
    return found->second;
  }

  const int n_;
  std::map<std::array<int, 3>, VertexId> vertices_;
};

}  // namespace

TriangleMesh Blocks(const std::array<int, 3>& cells, const std::function<bool(int, int, int)>& is_solid, int n) {
  const auto solid_at = [&](const std::array<int, 3>& c) {
    for (int axis = 0; axis < 3; ++axis) {
      if (c[axis] < 0 || c[axis] >= cells[axis]) return false;
    }
    return is_solid(c[0], c[1], c[2]);
  };
  CellFaces faces(n);
  for (int x = 0; x < cells[0]; ++x) {
    for (int y = 0; y < cells[1]; ++y) {
      for (int z = 0; z < cells[2]; ++z) {
        if (!is_solid(x, y, z)) continue;
        for (int side = 0; side < 6; ++side) {
          std::array<int, 3> beyond{x, y, z};
          beyond[side / 2] += side % 2 == 1 ? 1 : -1;
          if (!solid_at(beyond)) faces.AddFace({x, y, z}, side / 2, side % 2 == 1);
        }
      }
    }
  }
  return std::move(faces.mesh);
}

TriangleMesh Extruded(const TriangleMesh& flat, double height, int rows) {
  const auto count = static_cast<uint32_t>(flat.positions.size());
  const FaceAdjacency adjacency = CreateAdjacency(flat);
  TriangleMesh solid = Joined(Moved(flat, {0, 0, height}), Reversed(flat));
  std::map<std::pair<uint32_t, int>, VertexId> between;  // on the walls, by the vertex below and the row
  const auto at = [&](VertexId v, int row) {
    if (row == 0) return VertexId(v.index() + count);
    if (row == rows) return v;
    const auto [found, is_new] = between.try_emplace({v.index(), row}, solid.positions.size());
    if (is_new) solid.positions.push_back(flat.PositionAt(v) + Vec3{0, 0, height * row / rows});
    return found->second;
  };
  for (uint32_t h = 0; h < 3 * flat.triangles.size(); ++h) {
    if (adjacency.OppositeOf(h) != kNoHalfEdge) continue;
    const VertexId a = OriginOf(flat, h), b = TargetOf(flat, h);
    for (int row = 0; row < rows; ++row) AddSquare(solid, {at(a, row), at(b, row), at(b, row + 1), at(a, row + 1)});
  }
  return solid;
}

TriangleMesh PlateWithRoundHole(int n, double radius, double height) {
  return Extruded(Clipped(Sheet(n), [=](const Vec3& p) { return radius - std::hypot(p.x, p.y); }), height);
}

TriangleMesh Wedge(double angle, int n) {
  TriangleMesh flat;
  const Vec3 a{2, 0, 0}, b{2 * std::cos(angle), 2 * std::sin(angle), 0};
  const auto at = [](int i, int j) { return VertexId(i * (i + 1) / 2 + j); };  // row i has i + 1 vertices
  for (int i = 0; i <= n; ++i) {
    for (int j = 0; j <= i; ++j)
      flat.positions.push_back(static_cast<double>(i) / n * (i == 0 ? a : Lerp(a, b, static_cast<double>(j) / i)));
  }
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j <= i; ++j) flat.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
    for (int j = 0; j < i; ++j) flat.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
  }
  return Extruded(flat, 2, n);
}

TriangleMesh HalfDiskPrism() {
  std::vector<Vec3> points{{0, 0, 0}};
  for (int i = 0; i <= 24; ++i) points.push_back(OnCircle(kPi * i / 24));
  return Extruded(Fan(points), 1, 4);
}

TriangleMesh DropPrism() {
  std::vector<Vec3> points{{0, 0, 0}, {2, 0, 0}};
  // The tangents from the corner touch the circle at ±60°.
  for (int i = 0; i <= 16; ++i) points.push_back(OnCircle(kPi * (1.0 / 3 + 4.0 / 3 * i / 16)));
  return Extruded(ClosedFan(std::move(points)), 1, 4);
}

TriangleMesh Pillow() {
  TriangleMesh mesh;
  for (int i = 0; i < 3; ++i) mesh.positions.push_back(OnCircle(2 * kPi * i / 3));
  mesh.positions.push_back({0, 0, 0.1});
  mesh.positions.push_back({0, 0, -0.1});
  for (uint32_t i = 0; i < 3; ++i) {
    mesh.triangles.push_back({VertexId(i), VertexId((i + 1) % 3), VertexId(3)});
    mesh.triangles.push_back({VertexId((i + 1) % 3), VertexId(i), VertexId(4)});
  }
  return mesh;
}

TriangleMesh Lens(double height, int n) {
  const double radius = (1 + height * height) / (2 * height);  // of the spheres
  const TriangleMesh disk = Clipped(Sheet(n), [](const Vec3& p) { return std::hypot(p.x, p.y) - 0.999; });
  const auto cap = [&](double sign) {
    return Mapped(disk, [=](const Vec3& p) {
      const double r2 = (p.x * p.x + p.y * p.y) / (0.999 * 0.999);
      const double z = std::sqrt(radius * radius - r2) - (radius - height);
      return Vec3{p.x / 0.999, p.y / 0.999, std::abs(r2 - 1) < 1e-9 ? 0 : sign * z};
    });
  };
  TriangleMesh lens = Joined(cap(1), Reversed(cap(-1)));
  const FaceAdjacency adjacency = CreateAdjacency(disk);
  const auto half = static_cast<uint32_t>(disk.positions.size());
  for (uint32_t f = static_cast<uint32_t>(disk.triangles.size()); f < lens.triangles.size(); ++f) {
    for (VertexId& v : lens.triangles[f]) {
      if (adjacency.IsRimVertex(v.index() - half)) v = VertexId(v.index() - half);
    }
  }
  return WithoutUnreferenced(lens);
}

TriangleMesh Pyramid(double height) {
  TriangleMesh mesh;
  mesh.positions = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}, {0, 0, height}};
  for (uint32_t i = 0; i < 4; ++i) mesh.triangles.push_back({VertexId(i), VertexId((i + 1) % 4), VertexId(4)});
  AddSquare(mesh, {VertexId(0), VertexId(3), VertexId(2), VertexId(1)});
  return mesh;
}

TriangleMesh StarPrism(int points, double inner, double height) {
  std::vector<Vec3> around{{0, 0, 0}};
  for (int i = 0; i < 2 * points; ++i) around.push_back((i % 2 == 0 ? 1 : inner) * OnCircle(kPi * i / points));
  return Extruded(ClosedFan(std::move(around)), height);
}

TriangleMesh Fan(const std::vector<Vec3>& points) {
  TriangleMesh mesh;
  mesh.positions = points;
  for (uint32_t i = 2; i < points.size(); ++i) mesh.triangles.push_back({VertexId(0), VertexId(i - 1), VertexId(i)});
  return mesh;
}

}  // namespace meshfront::testing
