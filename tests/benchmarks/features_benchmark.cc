// Creases and loops, on a tray of many boxes: 80,000 triangles, a third of whose edges are creases at most.
#include <benchmark/benchmark.h>

#include <cmath>
#include <numbers>

#include "core/features/boundary.h"
#include "core/features/creases.h"
#include "core/surface/mesh_surface.h"

namespace meshfront {
namespace {

// A height field of square plateaus, `side` × `side` cells, flat between steep walls every `plateau` cells.
TriangleMesh Tray(uint32_t side, uint32_t plateau) {
  TriangleMesh mesh;
  const auto at = [&](uint32_t i, uint32_t j) { return VertexId(i * (side + 1) + j); };
  for (uint32_t i = 0; i <= side; ++i) {
    for (uint32_t j = 0; j <= side; ++j) {
      const bool is_high = (i / plateau + j / plateau) % 2 == 1;
      mesh.positions.push_back({1.0 * i, 1.0 * j, is_high ? 3.0 : 0.0});
    }
  }
  for (uint32_t i = 0; i < side; ++i) {
    for (uint32_t j = 0; j < side; ++j) {
      mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
  return mesh;
}
constexpr double kAngle = 40 * std::numbers::pi / 180;
const TriangleMesh& Mesh() {
  static const auto* mesh = new TriangleMesh(Tray(200, 10));
  return *mesh;
}
const FaceAdjacency& Adjacency() {
  static const auto* adjacency = new FaceAdjacency(CreateAdjacency(Mesh()));
  return *adjacency;
}
void PerTriangle(benchmark::State& state) {
  state.SetItemsProcessed(state.iterations() * static_cast<int64_t>(Mesh().triangles.size()));
}

void BM_Creases(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(FindCreases(Mesh(), Adjacency(), kAngle, Context{}));
  PerTriangle(state);
}
BENCHMARK(BM_Creases)->Unit(benchmark::kMillisecond);

void BM_LoopsAlongCreases(benchmark::State& state) {
  const std::vector<bool> creases = *FindCreases(Mesh(), Adjacency(), kAngle, Context{});
  const auto surface = *MeshSurface::Create(Mesh(), Adjacency(), creases, Context{});
  const GuidanceField field = *GuidanceField::Create({}, {1.2, 0, 1.0}, Context{});
  for (auto _ : state) benchmark::DoNotOptimize(BoundaryLoops(*surface, field, {}, Context{}));
  PerTriangle(state);
}
BENCHMARK(BM_LoopsAlongCreases)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace meshfront
