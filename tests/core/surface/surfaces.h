// Meshes as surfaces.
#pragma once

#include <memory>
#include <utility>

#include "core/surface/mesh_surface.h"
#include "gtest/gtest.h"

namespace meshfront::testing {

// With the curvatures at its vertices.
inline std::unique_ptr<MeshSurface> SurfaceOf(TriangleMesh mesh) {
  auto surface = MeshSurface::Create(std::move(mesh), Context{});
  EXPECT_TRUE(surface.ok()) << surface.status();
  const absl::Status fitted = (*surface)->ComputeCurvature(Context{});
  EXPECT_TRUE(fitted.ok()) << fitted;
  return *std::move(surface);
}

}  // namespace meshfront::testing
