// Kernels of core/geometry and core/mesh, against their budgets (design: what a triangle may cost).
#include <benchmark/benchmark.h>

#include <random>

#include "core/geometry/bvh.h"
#include "core/mesh/adjacency.h"
#include "core/mesh/repair.h"
#include "core/mesh/topology.h"
#include "tests/core/mesh/mesh_shapes.h"

namespace meshfront {
namespace {

// 2 n² triangles, in the order of a grid.
const TriangleMesh& TorusOf(int n) {
  static std::pair<int, TriangleMesh> kept;
  if (kept.first != n) kept = {n, shapes::Torus(n, n)};
  return kept.second;
}

void CountPerTriangle(benchmark::State& state, const TriangleMesh& mesh) {
  state.counters["ns_per_triangle"] =
      benchmark::Counter(double(mesh.triangles.size()) * 1e-9,
                         benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

void BM_CreateAdjacency(benchmark::State& state) {
  const TriangleMesh& mesh = TorusOf(int(state.range(0)));
  for (auto _ : state) benchmark::DoNotOptimize(CreateAdjacency(mesh));
  CountPerTriangle(state, mesh);
}
BENCHMARK(BM_CreateAdjacency)->Arg(200)->Arg(700);

void BM_CreateAdjacencyShuffled(benchmark::State& state) {
  const TriangleMesh mesh = shapes::Shuffled(TorusOf(int(state.range(0))), 1);
  for (auto _ : state) benchmark::DoNotOptimize(CreateAdjacency(mesh));
  CountPerTriangle(state, mesh);
}
BENCHMARK(BM_CreateAdjacencyShuffled)->Arg(200)->Arg(700);

void BM_MeasureTopology(benchmark::State& state) {
  const TriangleMesh& mesh = TorusOf(int(state.range(0)));
  for (auto _ : state) benchmark::DoNotOptimize(MeasureTopology(mesh));
  CountPerTriangle(state, mesh);
}
BENCHMARK(BM_MeasureTopology)->Arg(200)->Arg(700);

// A clean mesh: what every job pays.
void BM_RepairCleanMesh(benchmark::State& state) {
  TriangleMesh mesh = TorusOf(int(state.range(0)));
  for (auto _ : state) mesh = std::move(RepairMesh(std::move(mesh), Context{})->mesh);
  CountPerTriangle(state, mesh);
}
BENCHMARK(BM_RepairCleanMesh)->Arg(200)->Arg(370)->Arg(700);

// Every third face reversed and a rim to weld: the long way.
void BM_RepairBrokenMesh(benchmark::State& state) {
  TriangleMesh mesh = TorusOf(int(state.range(0)));
  for (size_t f = 0; f < mesh.triangles.size(); f += 3) shapes::Reverse(mesh.triangles[f]);
  for (auto _ : state) benchmark::DoNotOptimize(RepairMesh(mesh, Context{}));
  CountPerTriangle(state, mesh);
}
BENCHMARK(BM_RepairBrokenMesh)->Arg(200)->Arg(700);

void BM_BuildBvh(benchmark::State& state) {
  const TriangleMesh& mesh = TorusOf(int(state.range(0)));
  for (auto _ : state) benchmark::DoNotOptimize(TriangleBvh(mesh.positions, mesh.triangles));
  CountPerTriangle(state, mesh);
}
BENCHMARK(BM_BuildBvh)->Arg(30)->Arg(200)->Arg(700);

// Points within `range` hundredths of a small offset from the surface.
void BM_FindClosestPoint(benchmark::State& state) {
  const TriangleMesh& mesh = TorusOf(370);
  const TriangleBvh bvh(mesh.positions, mesh.triangles);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> offset(-0.01 * double(state.range(0)), 0.01 * double(state.range(0)));
  std::vector<Vec3> points;
  for (int i = 0; i < 4096; ++i) {
    points.push_back(mesh.positions[random() % mesh.positions.size()] +
                     Vec3{offset(random), offset(random), offset(random)});
  }
  size_t i = 0;
  for (auto _ : state) benchmark::DoNotOptimize(bvh.FindClosestPoint(points[i++ % points.size()]));
}
BENCHMARK(BM_FindClosestPoint)->Arg(1)->Arg(20);

void BM_FindFirstHit(benchmark::State& state) {
  const TriangleMesh& mesh = TorusOf(370);
  const TriangleBvh bvh(mesh.positions, mesh.triangles);
  size_t i = 0;
  for (auto _ : state) {
    i = (i + 7919) % mesh.positions.size();
    benchmark::DoNotOptimize(bvh.FindFirstHit({0, 0, 5}, mesh.positions[i] - Vec3{0, 0.01, 5}, 0, 2));
  }
}
BENCHMARK(BM_FindFirstHit);

}  // namespace
}  // namespace meshfront
