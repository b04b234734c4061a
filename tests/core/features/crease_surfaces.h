// Shapes whose creases meet in every way, cut along them.
#pragma once

#include <cmath>
#include <memory>
#include <numbers>
#include <utility>
#include <vector>

#include "core/features/creases.h"
#include "core/surface/mesh_surface.h"
#include "gtest/gtest.h"
#include "tests/support/shapes.h"

namespace meshfront::testing {

inline std::unique_ptr<MeshSurface> CreasedSurfaceOf(TriangleMesh mesh) {
  FaceAdjacency adjacency = CreateAdjacency(mesh);
  auto creases = FindCreases(mesh, adjacency, 40 * std::numbers::pi / 180, {});
  EXPECT_TRUE(creases.ok()) << creases.status();
  auto surface = MeshSurface::Create(std::move(mesh), std::move(adjacency), *creases, {});
  EXPECT_TRUE(surface.ok()) << surface.status();
  EXPECT_TRUE((*surface)->ComputeCurvature({}).ok());
  return *std::move(surface);
}

// n edges along the arc.
inline TriangleMesh HalfDisk(int n = 24) {
  std::vector<Vec3> points{{0, 0, 0}};
  for (int i = 0; i <= n; ++i) {
    const double angle = std::numbers::pi * i / n;
    points.push_back({std::cos(angle), std::sin(angle), 0});
  }
  return Fan(points);
}
// A prism over a half disk: one straight and one bent crease between the same two nodes, at the top and at the bottom.
inline TriangleMesh HalfDiskPrism() { return Extruded(HalfDisk(), 1, 4); }

// A prism over a drop, whose only corner is at (2, 0): its caps' creases run from a node to itself.
inline TriangleMesh DropPrism() {
  std::vector<Vec3> points{{0, 0, 0}, {2, 0, 0}};
  for (int i = 0; i <= 16; ++i) {
    const double angle = std::numbers::pi * (1.0 / 3 + 4.0 / 3 * i / 16);  // tangents from the corner touch here
    points.push_back({std::cos(angle), std::sin(angle), 0});
  }
  points.push_back(points[1]);
  TriangleMesh fan = Fan(points);
  for (VertexId& v : fan.triangles.back()) v = v.index() == 18 + 1 ? VertexId(1) : v;
  fan.positions.pop_back();
  return Extruded(fan, 1, 4);
}

// Two triangles with a sharp common rim, each raised a little in its middle: two patches inside the same three creases.
inline TriangleMesh Pillow() {
  TriangleMesh mesh;
  for (const double angle : {0.0, 2 * std::numbers::pi / 3, 4 * std::numbers::pi / 3})
    mesh.positions.push_back({std::cos(angle), std::sin(angle), 0});
  mesh.positions.push_back({0, 0, 0.1});
  mesh.positions.push_back({0, 0, -0.1});
  for (uint32_t i = 0; i < 3; ++i) {
    mesh.triangles.push_back({VertexId(i), VertexId((i + 1) % 3), VertexId(3)});
    mesh.triangles.push_back({VertexId((i + 1) % 3), VertexId(i), VertexId(4)});
  }
  return mesh;
}

// A sheet folded along y = 0: one crease from rim to rim.
inline TriangleMesh Roof(int n = 10) {
  return HeightField(n, [](double, double y) { return -std::abs(y); });
}

// A cube [-1, 1]³ without the face z = 1.
inline TriangleMesh OpenBox(int n) {
  TriangleMesh box = Cube(n);
  std::erase_if(box.triangles, [&](const Triangle& t) {
    return box.PositionAt(t[0]).z == 1 && box.PositionAt(t[1]).z == 1 && box.PositionAt(t[2]).z == 1;
  });
  return WithoutUnreferenced(box);
}

}  // namespace meshfront::testing
