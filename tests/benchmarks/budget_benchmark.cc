// What each step may cost (`budget`, seconds an item, on one core of the build machine), and what it does cost (`per_item`). The mesh
// is as large as a scan: 134,400 triangles, uneven, bumpy.
#include <benchmark/benchmark.h>

#include <chrono>
#include <string>
#include <vector>

#include "core/front/advancing_front.h"
#include "core/geometry/bvh.h"
#include "core/guidance/guidance_field.h"
#include "core/io/mesh_io.h"
#include "core/surface/curvature_fit.h"
#include "core/surface/mesh_surface.h"
#include "core/surface/vertex_normals.h"
#include "tests/benchmarks/subjects.h"

namespace meshfront {
namespace {

constexpr double kRho = 0.5, kEta = 1.2;

const TriangleMesh& Mesh() {
  static const auto* mesh = new TriangleMesh(WavyTorus(420, 160));
  return *mesh;
}

const MeshSurface& Surface() {
  static const auto* surface = SurfaceOf(Mesh()).release();
  return *surface;
}

std::vector<SizingSample> Samples() {
  std::vector<SizingSample> samples;
  const auto curvature = *Surface().CurvatureSamples([](double k) { return IdealLength(kRho, k); }, true, Context{});
  for (const auto& s : curvature) samples.push_back({s.position, IdealLength(kRho, s.max_curvature)});
  return samples;
}

GuidanceField FieldOf(std::vector<SizingSample> samples) {
  return *GuidanceField::Create(std::move(samples), {kEta, 1e-4, 1}, Context{});
}

// `budget` in seconds.
void Count(benchmark::State& state, double items, double budget) {
  state.counters["per_item"] =
      benchmark::Counter(items, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
  state.counters["budget"] = budget;
}

// Per vertex of the file; STL repeats every corner.
void BM_Read(benchmark::State& state, Format format) {
  const std::string bytes = *FormatMesh(Mesh(), format);
  const absl::Span<const uint8_t> span(reinterpret_cast<const uint8_t*>(bytes.data()), bytes.size());
  for (auto _ : state) benchmark::DoNotOptimize(*ReadMesh(span, format, "benchmark"));
  const size_t vertices = format == Format::kStl ? 3 * Mesh().triangles.size() : Mesh().positions.size();
  Count(state, static_cast<double>(vertices), 0.3e-6);
}
BENCHMARK_CAPTURE(BM_Read, ply, Format::kPly)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(BM_Read, stl, Format::kStl)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(BM_Read, glb, Format::kGlb)->Unit(benchmark::kMillisecond);

// Per triangle.
void BM_AdjacencyAndBvh(benchmark::State& state) {
  for (auto _ : state) {
    benchmark::DoNotOptimize(CreateAdjacency(Mesh()));
    benchmark::DoNotOptimize(TriangleBvh(Mesh().positions, Mesh().triangles));
  }
  Count(state, static_cast<double>(Mesh().triangles.size()), 0.5e-6);
}
BENCHMARK(BM_AdjacencyAndBvh)->Unit(benchmark::kMillisecond);

// Per vertex.
void BM_Curvature(benchmark::State& state) {
  const FaceAdjacency adjacency = CreateAdjacency(Mesh());
  const std::vector<Vec3> normals = ComputeVertexNormals(Mesh());
  for (auto _ : state) benchmark::DoNotOptimize(FitMaxCurvatures(Mesh(), adjacency, normals, Context{}));
  Count(state, static_cast<double>(Mesh().positions.size()), 2e-6);
}
BENCHMARK(BM_Curvature)->Unit(benchmark::kMillisecond);

// Per sample: collecting them, the distances to other sheets among it, pruning and indexing.
void BM_Field(benchmark::State& state) {
  size_t count = 0;
  for (auto _ : state) {
    std::vector<SizingSample> samples = Samples();
    count = samples.size();
    benchmark::DoNotOptimize(FieldOf(std::move(samples)));
  }
  Count(state, static_cast<double>(count), 1e-6);
}
BENCHMARK(BM_Field)->Unit(benchmark::kMillisecond);

// Per value, from one vertex to the next, as the front asks.
void BM_At(benchmark::State& state) {
  const GuidanceField field = FieldOf(Samples());
  const double slope = 1 - 1 / kEta;
  size_t i = 0;
  Vec3 from = Mesh().positions[0];
  double last = field.At(from);
  for (auto _ : state) {
    i = i + 1 == Mesh().positions.size() ? 0 : i + 1;
    const Vec3& x = Mesh().positions[i];
    last = field.At(x, (last + slope * Distance(from, x)) * (1 + 1e-14));
    benchmark::DoNotOptimize(last);
    from = x;
  }
  Count(state, 1, 0.4e-6);
}
BENCHMARK(BM_At);

// Per vertex, over edges as long as the field has them.
void BM_PlaceFreeVertex(benchmark::State& state) {
  const GuidanceField field = FieldOf(Samples());
  struct Edge {
    SourcePoint a, b;
    double length;
  };
  std::vector<Edge> edges;
  for (uint32_t f = 0; f < Mesh().triangles.size(); f += 13) {
    const SourcePoint a = Surface().AtFace(FaceId(f), 0.3, 0.3);
    const double g = field.At(a.position);
    const Vec3 across = Normalized(Cross(a.normal, std::abs(a.normal.z) < 0.9 ? Vec3{0, 0, 1} : Vec3{1, 0, 0}));
    edges.push_back({a, Surface().Snap(a, a.position + g * across), g});
  }
  size_t i = 0;
  for (auto _ : state) {
    const Edge& e = edges[i];
    i = i + 1 == edges.size() ? 0 : i + 1;
    benchmark::DoNotOptimize(Surface().FindApex(e.a, e.b, e.length, e.length));
  }
  Count(state, 1, 1e-6);
}
BENCHMARK(BM_PlaceFreeVertex);

// Seconds for the whole front, and its triangles.
std::pair<double, size_t> Advance(const GuidanceField& field, bool settled, double max_error = INFINITY) {
  CountingSink sink;
  const FrontOptions options{
      .flips = settled, .smooth = settled, .fit = settled, .max_error = max_error, .max_insertions = 1e6};
  const auto start = std::chrono::steady_clock::now();
  if (!AdvanceFront(Surface(), field, {}, {Surface().AtFace(FaceId(0), 0.3, 0.3)}, options, sink, Context{}).ok())
    std::abort();
  return {std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(), sink.triangles};
}

// Per triangle: placing, proposing and accepting.
void BM_FrontWithoutSettling(benchmark::State& state) {
  const GuidanceField field = FieldOf(Samples());
  size_t triangles = 0;
  for (auto _ : state) triangles = Advance(field, false).second;
  Count(state, static_cast<double>(triangles), 2e-6);
}
BENCHMARK(BM_FrontWithoutSettling)->Unit(benchmark::kMillisecond);

// Per triangle: what flips, smoothing, search and fit take beyond the front without them.
void BM_Settle(benchmark::State& state) {
  const GuidanceField field = FieldOf(Samples());
  size_t triangles = 0;
  for (auto _ : state) {
    const double plain = Advance(field, false).first;
    const auto [seconds, count] = Advance(field, true);
    state.SetIterationTime(std::max(0.0, seconds - plain));
    triangles = count;
  }
  Count(state, static_cast<double>(triangles), 2e-6);
}
BENCHMARK(BM_Settle)->UseManualTime()->Unit(benchmark::kMillisecond);

// Per triangle: what a bound takes beyond that, that few exceed where a count is wanted. Argument: in ten thousandths.
void BM_KeepMaxError(benchmark::State& state) {
  const GuidanceField field = FieldOf(Samples());
  size_t triangles = 0;
  for (auto _ : state) {
    const double unbounded = Advance(field, true).first;
    const auto [seconds, count] = Advance(field, true, 1e-4 * static_cast<double>(state.range(0)));
    state.SetIterationTime(std::max(0.0, seconds - unbounded));
    triangles = count;
  }
  Count(state, static_cast<double>(triangles), 2e-6);
}
BENCHMARK(BM_KeepMaxError)->Arg(10)->Arg(100)->UseManualTime()->Unit(benchmark::kMillisecond);

// Per triangle: 250,000 a second.
void BM_Front(benchmark::State& state) {
  const GuidanceField field = FieldOf(Samples());
  size_t triangles = 0;
  for (auto _ : state) triangles = Advance(field, true).second;
  Count(state, static_cast<double>(triangles), 4e-6);
}
BENCHMARK(BM_Front)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace meshfront
