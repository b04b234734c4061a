// What benchmarks measure on: an uneven mesh and its surface, and a sink that counts.
#pragma once

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <numbers>
#include <random>

#include "core/mesh/mesh_sink.h"
#include "core/mesh/triangle_mesh.h"
#include "core/surface/mesh_surface.h"

namespace meshfront {

// A torus with waves on it, 2 · around · along triangles, its vertices jittered.
inline TriangleMesh WavyTorus(uint32_t around, uint32_t along) {
  TriangleMesh mesh;
  std::mt19937 random(1);
  std::uniform_real_distribution<double> jitter(-0.3, 0.3);
  for (uint32_t i = 0; i < around * along; ++i) {
    const double a = 2 * std::numbers::pi * (i / along + jitter(random)) / around;
    const double b = 2 * std::numbers::pi * (i % along + jitter(random)) / along;
    const double tube = 0.4 + 0.03 * std::sin(9 * a) * std::cos(4 * b), ring = 1 + tube * std::cos(b);
    mesh.positions.push_back({ring * std::cos(a), ring * std::sin(a), tube * std::sin(b)});
  }
  const auto at = [&](uint32_t i, uint32_t j) { return VertexId((i % around) * along + j % along); };
  for (uint32_t i = 0; i < around; ++i) {
    for (uint32_t j = 0; j < along; ++j) {
      mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
  return mesh;
}

// The surface of a mesh, with its curvature.
inline std::unique_ptr<MeshSurface> SurfaceOf(const TriangleMesh& mesh) {
  auto surface = *MeshSurface::Create(mesh, Context{});
  if (!surface->ComputeCurvature(Context{}).ok()) std::abort();
  return surface;
}

class CountingSink : public MeshSink {
 public:
  absl::Status Append(const MeshPiece& piece) override {
    triangles += piece.triangles.size();
    return absl::OkStatus();
  }
  size_t triangles = 0;
};

}  // namespace meshfront
