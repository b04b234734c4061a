// Advancing over surfaces by formula, so that only the front is measured, and asking the fence index.
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "benchmark/benchmark.h"
#include "core/front/advancing_front.h"
#include "core/front/fence_index.h"
#include "core/geometry/loop_triangulation.h"
#include "tests/benchmarks/subjects.h"
#include "tests/core/front/fake_surfaces.h"

namespace meshfront {
namespace {

using testing::SphereSurface;
using testing::TorusSurface;

// Lengths as a 1000 kept samples give them: graded by a factor of three.
GuidanceField FieldFor(double length) {
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  std::vector<SizingSample> samples;
  for (int i = 0; i < 1000; ++i) {
    const Vec3 p = 2 * Normalized(Vec3{normal(random), normal(random), normal(random)});
    samples.push_back({p, length * (1 + std::abs(p.z))});
  }
  return *GuidanceField::Create(std::move(samples), {1.2, 0, 3 * length}, {});
}

FrontOptions OptionsOf(bool settled) { return {.flips = settled, .smooth = settled, .fit = settled}; }

void Advance(benchmark::State& state, const Surface& surface, const SourcePoint& seed) {
  const GuidanceField field = FieldFor(1.0 / static_cast<double>(state.range(0)));
  CountingSink sink;
  FrontReport report;
  for (auto _ : state) report = *AdvanceFront(surface, field, {}, {seed}, OptionsOf(state.range(1)), sink, {});
  state.counters["triangles"] = static_cast<double>(report.triangles);
  state.counters["triangles_per_s"] =
      benchmark::Counter(static_cast<double>(sink.triangles), benchmark::Counter::kIsRate);
  state.counters["peak_front_edges"] = static_cast<double>(report.peak_front_edges);
  state.counters["roll_backs"] = static_cast<double>(report.roll_backs);
}

// `settled`: with flips, smoothing and fit.
void BM_AdvanceOverASphere(benchmark::State& state) {
  const SphereSurface sphere(2);
  Advance(state, sphere, sphere.Project({2, 0, 0}, 0));
}
BENCHMARK(BM_AdvanceOverASphere)
    ->ArgNames({"fineness", "settled"})
    ->ArgsProduct({{15, 45}, {0, 1}})
    ->Unit(benchmark::kMillisecond);

void BM_AdvanceOverATorus(benchmark::State& state) {
  const TorusSurface torus(2, 0.7);
  Advance(state, torus, torus.Project({2.7, 0, 0}, 0));
}
BENCHMARK(BM_AdvanceOverATorus)
    ->ArgNames({"fineness", "settled"})
    ->ArgsProduct({{15, 45}, {0, 1}})
    ->Unit(benchmark::kMillisecond);

// A long front as a spiral of edges, `octaves` of lengths on it; queries as a connection search makes them.
void BM_QueryFences(benchmark::State& state) {
  constexpr int kEdges = 20000;
  FrontSet fronts;
  std::vector<WindowVertexId> loop;
  double angle = 0, radius = 1;
  const double growth = std::exp2(static_cast<double>(state.range(0)) / kEdges);
  for (int i = 0; i < kEdges; ++i, radius *= growth, angle += 0.02) {
    loop.push_back(fronts.AddVertex({radius * Vec3{std::cos(angle), std::sin(angle), 0}, {0, 0, 1}}, 0.02 * radius, 0));
  }
  FrontEdgeId e = fronts.AddLoop(loop);
  FenceIndex index(fronts);
  for (int i = 0; i < kEdges; ++i, e = fronts.at(e).next) index.Insert(e);
  std::vector<FrontEdgeId> found;
  size_t i = 0, total = 0;
  for (auto _ : state) {
    found.clear();
    const WindowVertex& v = fronts.at(loop[i]);
    index.Query(v.position, 1.6 * v.length, found);
    total += found.size();
    i = (i + 7919) % kEdges;
  }
  state.counters["found"] = benchmark::Counter(static_cast<double>(total), benchmark::Counter::kAvgIterations);
}
BENCHMARK(BM_QueryFences)->ArgName("octaves")->Arg(1)->Arg(10);

void BM_InsertAndEraseFences(benchmark::State& state) {
  FrontSet fronts;
  std::vector<WindowVertexId> loop;
  for (int i = 0; i < 1000; ++i) {
    const double angle = 2 * std::numbers::pi * i / 1000;
    loop.push_back(fronts.AddVertex({{std::cos(angle), std::sin(angle), 0}, {0, 0, 1}}, 0.006, 1));
  }
  FrontEdgeId e = fronts.AddLoop(loop);
  FenceIndex index(fronts);
  for (int i = 0; i < 1000; ++i, e = fronts.at(e).next) index.Insert(e);
  for (auto _ : state) {
    index.Erase(e);
    index.Insert(e);
    e = fronts.at(e).next;
  }
}
BENCHMARK(BM_InsertAndEraseFences);

void BM_TriangulateLoop(benchmark::State& state) {
  const int n = static_cast<int>(state.range(0));
  for (auto _ : state) {
    benchmark::DoNotOptimize(
        TriangulateLoop(n, [](int first, int apex, int last) { return (first * 31 + apex * 17 + last * 7) % 101; }));
  }
}
BENCHMARK(BM_TriangulateLoop)->Arg(8)->Arg(64)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace meshfront
