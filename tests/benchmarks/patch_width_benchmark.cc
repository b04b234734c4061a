// The kernels of core/features: the widths of an open ribbon, coarsely and finely meshed, and what a closed surface pays for them.
#include <benchmark/benchmark.h>

#include <cmath>
#include <cstdlib>
#include <memory>
#include <vector>

#include "core/features/patch_width.h"

namespace meshfront {
namespace {

// [0, length] × [0, 1] in squares of side 1 / across, waving gently.
TriangleMesh Ribbon(uint32_t across, uint32_t length) {
  TriangleMesh mesh;
  const uint32_t along = across * length;
  for (uint32_t i = 0; i <= along; ++i) {
    for (uint32_t j = 0; j <= across; ++j) {
      const double x = static_cast<double>(i) / across, y = static_cast<double>(j) / across;
      mesh.positions.push_back({x, y, 0.1 * std::sin(x) * std::cos(2 * y)});
    }
  }
  const auto at = [&](uint32_t i, uint32_t j) { return VertexId(i * (across + 1) + j); };
  for (uint32_t i = 0; i < along; ++i) {
    for (uint32_t j = 0; j < across; ++j) {
      mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
  return mesh;
}

void BM_PatchWidths(benchmark::State& state) {
  auto surface = MeshSurface::Create(Ribbon(static_cast<uint32_t>(state.range(0)), 200), Context{});
  if (!surface.ok()) std::abort();
  const std::vector<WidthRange> ranges{{1e-3, 2}};
  for (auto _ : state) benchmark::DoNotOptimize(MeasurePatchWidths(**surface, ranges, Context{}));
  const int64_t rim_edges = 2 * (200 + 1) * state.range(0);
  state.SetItemsProcessed(state.iterations() * rim_edges);
}
BENCHMARK(BM_PatchWidths)->Arg(1)->Arg(8)->Arg(32)->Unit(benchmark::kMicrosecond);

// What a closed surface without creases pays: a look at its half-edges.
void BM_PatchWidthsWithoutRims(benchmark::State& state) {
  TriangleMesh torus;
  const uint32_t n = 200;
  for (uint32_t i = 0; i < n; ++i) {
    for (uint32_t j = 0; j < n; ++j) {
      const double a = 2 * M_PI * i / n, b = 2 * M_PI * j / n;
      torus.positions.push_back(
          {(1 + 0.4 * std::cos(b)) * std::cos(a), (1 + 0.4 * std::cos(b)) * std::sin(a), 0.4 * std::sin(b)});
      const auto at = [&](uint32_t u, uint32_t v) { return VertexId(u % n * n + v % n); };
      torus.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      torus.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
  const auto faces = static_cast<int64_t>(torus.triangles.size());
  auto surface = MeshSurface::Create(std::move(torus), Context{});
  if (!surface.ok()) std::abort();
  for (auto _ : state) benchmark::DoNotOptimize(MeasurePatchWidths(**surface, {{1e-3, 2}}, Context{}));
  state.SetItemsProcessed(state.iterations() * faces);
}
BENCHMARK(BM_PatchWidthsWithoutRims)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace meshfront
