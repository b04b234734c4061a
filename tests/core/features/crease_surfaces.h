// Shapes whose creases meet in every way, cut along them.
#pragma once

#include <algorithm>
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
