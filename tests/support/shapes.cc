// Everything is one of four constructions: a grid over (u, v), the surface of a box's grid, a subdivided icosahedron, or a
// zero set (iso_surface.cc); the rest is maps, copies and cuts of those.
#include "tests/support/shapes.h"

#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>
#include <vector>

namespace meshfront::testing {
namespace {

constexpr double kPi = std::numbers::pi;

void AddTriangle(TriangleMesh& mesh, int a, int b, int c) {
  mesh.triangles.push_back({VertexId(a), VertexId(b), VertexId(c)});
}

// Two triangles over the square a, b, c, d, cut along a–c or b–d by turns so that no direction is preferred.
void AddSquare(TriangleMesh& mesh, std::array<int, 4> v, bool other_diagonal) {
  if (other_diagonal) v = {v[1], v[2], v[3], v[0]};
  AddTriangle(mesh, v[0], v[1], v[2]);
  AddTriangle(mesh, v[0], v[2], v[3]);
}

// Vertices at(i, j), i < nu, j < nv; u runs to the right and v up when looked at from outside.
TriangleMesh Grid(int nu, int nv, bool wrap_u, bool wrap_v, const std::function<Vec3(int, int)>& at) {
  TriangleMesh mesh;
  for (int j = 0; j < nv; ++j) {
    for (int i = 0; i < nu; ++i) mesh.positions.push_back(at(i, j));
  }
  for (int j = 0; j < (wrap_v ? nv : nv - 1); ++j) {
    for (int i = 0; i < (wrap_u ? nu : nu - 1); ++i) {
      const int right = (i + 1) % nu, up = (j + 1) % nv;
      AddSquare(mesh, {j * nu + i, j * nu + right, up * nu + right, up * nu + i}, (i + j) % 2 == 1);
    }
  }
  return mesh;
}

// The six faces of the grid of planes x = xs[i], y = ys[j], z = zs[k].
class BoxGrid {
 public:
  BoxGrid(const std::vector<double>& xs, const std::vector<double>& ys, const std::vector<double>& zs)
      : planes_{xs, ys, zs} {
    for (int axis = 0; axis < 3; ++axis) {
      AddFace(axis, false);
      AddFace(axis, true);
    }
  }
  TriangleMesh mesh;

 private:
  int VertexAt(const std::array<int, 3>& cell) {
    const auto [it, added] = vertices_.try_emplace(cell, static_cast<int>(mesh.positions.size()));
    if (added) mesh.positions.push_back({planes_[0][cell[0]], planes_[1][cell[1]], planes_[2][cell[2]]});
    return it->second;
  }
  void AddFace(int axis, bool far_side) {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    std::array<int, 3> cell{};
    cell[axis] = far_side ? static_cast<int>(planes_[axis].size()) - 1 : 0;
    const auto corner = [&](int i, int j) {
      std::array<int, 3> at = cell;
      at[u] = i, at[v] = j;
      return VertexAt(at);
    };
    for (int j = 0; j + 1 < static_cast<int>(planes_[v].size()); ++j) {
      for (int i = 0; i + 1 < static_cast<int>(planes_[u].size()); ++i) {
        std::array<int, 4> square{corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)};
        if (!far_side) std::swap(square[1], square[3]);
        AddSquare(mesh, square, (i + j) % 2 == 1);
      }
    }
  }

  std::array<std::vector<double>, 3> planes_;
  std::map<std::array<int, 3>, int> vertices_;
};

// The planes of one axis of a rounded box: the rim, the core, the rim.
std::vector<double> RimAndCore(double half, double radius, int core, int rim) {
  std::vector<double> at;
  const double outer = half + radius;
  // Equal angles along the quarter circle that the box's outer shell is projected to.
  const auto rim_step = [&](int i) { return radius * std::tan(kPi / 4 * i / rim); };
  for (int i = rim; i > 0 && radius > 0; --i) at.push_back(i == rim ? -outer : -half - rim_step(i));
  at.push_back(-half);
  for (int i = 1; i <= core && half > 0; ++i) at.push_back(i == core ? half : -half + 2 * half * i / core);
  for (int i = 1; i <= rim && radius > 0; ++i) at.push_back(i == rim ? outer : half + rim_step(i));
  return at;
}

TriangleMesh Icosahedron() {
  const double g = (1 + std::sqrt(5.0)) / 2;
  TriangleMesh mesh;
  mesh.positions = {{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                    {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
  constexpr int kFaces[20][3] = {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                                 {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                                 {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
  for (const auto& f : kFaces) AddTriangle(mesh, f[0], f[1], f[2]);
  return mesh;
}

// Every triangle into four, at the middles of its edges.
TriangleMesh Subdivided(const TriangleMesh& coarse) {
  TriangleMesh fine;
  fine.positions = coarse.positions;
  std::map<std::pair<uint32_t, uint32_t>, int> middles;
  const auto middle = [&](VertexId a, VertexId b) {
    const auto [it, added] =
        middles.try_emplace(std::minmax(a.index(), b.index()), static_cast<int>(fine.positions.size()));
    if (added) fine.positions.push_back(0.5 * (coarse.PositionAt(a) + coarse.PositionAt(b)));
    return it->second;
  };
  for (const Triangle& t : coarse.triangles) {
    const int ab = middle(t[0], t[1]), bc = middle(t[1], t[2]), ca = middle(t[2], t[0]);
    const int a = static_cast<int>(t[0].index()), b = static_cast<int>(t[1].index()),
              c = static_cast<int>(t[2].index());
    AddTriangle(fine, a, ab, ca);
    AddTriangle(fine, b, bc, ab);
    AddTriangle(fine, c, ca, bc);
    AddTriangle(fine, ab, bc, ca);
  }
  return fine;
}

// Closes a ring of `around` vertices starting at `first` with a fan around a new vertex.
void AddPole(TriangleMesh& mesh, const Vec3& pole, int first, int around, bool north) {
  const int apex = static_cast<int>(mesh.positions.size());
  mesh.positions.push_back(pole);
  for (int i = 0; i < around; ++i) {
    const int a = first + i, b = first + (i + 1) % around;
    north ? AddTriangle(mesh, a, b, apex) : AddTriangle(mesh, b, a, apex);
  }
}

}  // namespace

TriangleMesh Icosphere(int subdivisions, double radius) {
  TriangleMesh mesh = Icosahedron();
  for (int i = 0; i < subdivisions; ++i) {
    mesh = Mapped(Subdivided(mesh), [](const Vec3& p) { return Normalized(p); });
  }
  return Mapped(std::move(mesh), [&](const Vec3& p) { return radius * Normalized(p); });
}

TriangleMesh Ellipsoid(int subdivisions, const Vec3& s) {
  return Mapped(Icosphere(subdivisions), [&](const Vec3& p) { return Vec3{s.x * p.x, s.y * p.y, s.z * p.z}; });
}

TriangleMesh UvSphere(int around, int rings, double radius) {
  TriangleMesh mesh = Grid(around, rings, true, false, [&](int i, int j) {
    const double longitude = 2 * kPi * i / around, latitude = kPi * (j + 1) / (rings + 1) - kPi / 2;
    return radius *
           Vec3{std::cos(latitude) * std::cos(longitude), std::cos(latitude) * std::sin(longitude), std::sin(latitude)};
  });
  AddPole(mesh, {0, 0, -radius}, 0, around, false);
  AddPole(mesh, {0, 0, radius}, (rings - 1) * around, around, true);
  return mesh;
}

TriangleMesh Torus(double major_radius, double minor_radius, int around, int along) {
  return Grid(around, along, true, true, [&](int i, int j) {
    const double u = 2 * kPi * i / around, v = 2 * kPi * j / along;
    const double r = major_radius + minor_radius * std::cos(v);
    return Vec3{r * std::cos(u), r * std::sin(u), minor_radius * std::sin(v)};
  });
}

TriangleMesh GenusThree(int cells) {
  // The smooth minimum of three tori's distances; neighbours overlap by a little less than a tube's width.
  constexpr double kMajor = 0.8, kMinor = 0.3, kSpacing = 1.9, kMelt = 0.06;
  const auto torus = [&](const Vec3& p) { return std::hypot(std::hypot(p.x, p.y) - kMajor, p.z) - kMinor; };
  const auto f = [&](const Vec3& p) {
    double sum = 0;
    for (int i = -1; i <= 1; ++i) sum += std::exp(-torus(p - Vec3{kSpacing * i, 0, 0}) / kMelt);
    return -kMelt * std::log(sum);
  };
  return IsoSurface(f, {{-3.3, -1.4, -0.6}, {3.3, 1.4, 0.6}}, cells);
}

TriangleMesh Cube(int n) { return RoundedBox({1, 1, 1}, 0, n, 0); }

TriangleMesh RoundedBox(const Vec3& half, double radius, int core, int rim) {
  BoxGrid grid(RimAndCore(half.x, radius, core, rim), RimAndCore(half.y, radius, core, rim),
               RimAndCore(half.z, radius, core, rim));
  if (radius <= 0) return std::move(grid.mesh);
  return Mapped(std::move(grid.mesh), [&](const Vec3& p) {
    const Vec3 inner = Max(-half, Min(p, half));
    return inner + radius * Normalized(p - inner);
  });
}

TriangleMesh Capsule(double length, double radius, int core, int rim) {
  return RoundedBox({0, 0, 0.5 * length}, radius, core, rim);
}

TriangleMesh ThinSlab(int n, double thickness, int rim) {
  const double radius = 0.5 * thickness;
  return RoundedBox({1 - radius, 1 - radius, 0}, radius, n, rim);
}

TriangleMesh OpenCylinder(double radius, double height, int around, int along) {
  return Grid(around, along + 1, true, false, [&](int i, int j) {
    const double u = 2 * kPi * i / around;
    return Vec3{radius * std::cos(u), radius * std::sin(u), height * (static_cast<double>(j) / along - 0.5)};
  });
}

TriangleMesh CappedCylinder(double radius, double height, int around, int along) {
  TriangleMesh mesh = OpenCylinder(radius, height, around, along);
  AddPole(mesh, {0, 0, -0.5 * height}, 0, around, false);
  AddPole(mesh, {0, 0, 0.5 * height}, along * around, around, true);
  return mesh;
}

TriangleMesh TwoSpheres(int subdivisions) {
  return Joined(Icosphere(subdivisions), Moved(Icosphere(subdivisions), {3, 0, 0}));
}

TriangleMesh ParallelTubes(double gap, double length, int core, int rim) {
  const TriangleMesh tube = Capsule(length, 1, core, rim);
  return Joined(Moved(tube, {-1 - 0.5 * gap, 0, 0}), Moved(tube, {1 + 0.5 * gap, 0, 0}));
}

TriangleMesh ConcentricShells(int subdivisions, double inner_radius) {
  return Joined(Icosphere(subdivisions), Reversed(Icosphere(subdivisions, inner_radius)));
}

TriangleMesh Sheet(int n) {
  return HeightField(n, [](double, double) { return 0.0; });
}

TriangleMesh HeightField(int n, const std::function<double(double, double)>& height) {
  return Grid(n + 1, n + 1, false, false, [&](int i, int j) {
    const double x = 2.0 * i / n - 1, y = 2.0 * j / n - 1;
    return Vec3{x, y, height(x, y)};
  });
}

TriangleMesh WavyTerrain(int n) {
  return HeightField(n, [](double x, double y) { return 0.15 * std::sin(2 * kPi * x) * std::cos(2 * kPi * y); });
}

TriangleMesh DiskWithHoles(int n, int holes) {
  TriangleMesh dome = HeightField(n, [](double x, double y) { return 0.25 * (1 - x * x - y * y); });
  dome = Mapped(std::move(dome), [](const Vec3& p) { return Vec3{1.05 * p.x, 1.05 * p.y, p.z}; });
  return Clipped(dome, [&](const Vec3& p) {
    double outside = std::hypot(p.x, p.y) - 1;
    for (int i = 0; i < holes; ++i) {
      const double u = 2 * kPi * i / holes + 0.3;
      outside = std::max(outside, 0.15 - std::hypot(p.x - 0.55 * std::cos(u), p.y - 0.55 * std::sin(u)));
    }
    return outside;
  });
}

TriangleMesh Hemisphere(int subdivisions) {
  const TriangleMesh half = Clipped(Icosphere(subdivisions), [](const Vec3& p) { return -p.z; });
  return Mapped(half, [](const Vec3& p) { return Normalized(p); });
}

}  // namespace meshfront::testing
