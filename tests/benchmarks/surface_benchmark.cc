// The kernels of core/surface on a generated, uneven mesh: a wavy torus of 80,000 triangles with jittered vertices.
#include <benchmark/benchmark.h>

#include <cmath>
#include <random>

#include "core/guidance/sizing.h"
#include "core/surface/curvature_average.h"
#include "core/surface/curvature_fit.h"
#include "core/surface/mesh_surface.h"
#include "core/surface/vertex_normals.h"
#include "tests/benchmarks/subjects.h"

namespace meshfront {
namespace {

const TriangleMesh& Mesh() {
  static const auto* mesh = new TriangleMesh(WavyTorus(320, 125));
  return *mesh;
}
const MeshSurface& Surface() {
  static const auto* surface = SurfaceOf(Mesh()).release();
  return *surface;
}
double MeanEdge() {
  const TriangleMesh& mesh = Mesh();
  double sum = 0;
  for (const Triangle& t : mesh.triangles) sum += Distance(mesh.PositionAt(t[0]), mesh.PositionAt(t[1]));
  return sum / static_cast<double>(mesh.triangles.size());
}

void PerVertex(benchmark::State& state) {
  state.SetItemsProcessed(state.iterations() * static_cast<int64_t>(Mesh().positions.size()));
}

void BM_Create(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(MeshSurface::Create(Mesh(), Context{}));
  PerVertex(state);
}
BENCHMARK(BM_Create)->Unit(benchmark::kMillisecond);

void BM_Curvature(benchmark::State& state) {
  const FaceAdjacency adjacency = CreateAdjacency(Mesh());
  const std::vector<Vec3> normals = ComputeVertexNormals(Mesh());
  for (auto _ : state) benchmark::DoNotOptimize(FitMaxCurvatures(Mesh(), adjacency, normals, Context{}));
  PerVertex(state);
}
BENCHMARK(BM_Curvature)->Unit(benchmark::kMillisecond);

// Argument: edges of the mesh to come, in mean input edges; the more, the more passes.
void BM_CurvatureAverage(benchmark::State& state) {
  const double length = static_cast<double>(state.range(0)) * MeanEdge();
  for (auto _ : state) {
    auto average = *CurvatureAverage::Create(Surface(), Context{});
    benchmark::DoNotOptimize(average.ForEdges([&](double) { return length; }, 1, Context{}));
  }
  PerVertex(state);
}
BENCHMARK(BM_CurvatureAverage)->Arg(2)->Arg(5)->Unit(benchmark::kMillisecond);

// Argument: with thickness.
void BM_Samples(benchmark::State& state) {
  const auto length = [](double curvature) { return IdealLength(0.8, curvature); };
  for (auto _ : state) benchmark::DoNotOptimize(Surface().CurvatureSamples(length, state.range(0) != 0, Context{}));
  PerVertex(state);
}
BENCHMARK(BM_Samples)->Arg(0)->Arg(1)->Unit(benchmark::kMillisecond);

// Pairs of ends as a front makes them, `ratio` mean input edges apart, in the order of the mesh.
std::vector<std::pair<SourcePoint, SourcePoint>> Edges(double length) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> unit(-1, 1);
  std::vector<std::pair<SourcePoint, SourcePoint>> edges;
  for (uint32_t f = 0; f < Mesh().triangles.size(); f += 13) {
    const SourcePoint a = Surface().AtFace(FaceId(f), 0.3, 0.3);
    const Vec3 direction{unit(random), unit(random), unit(random)};
    const SourcePoint b =
        Surface().Snap(a, a.position + length * Normalized(direction - Dot(direction, a.normal) * a.normal));
    edges.emplace_back(a, b);
  }
  return edges;
}

// Argument: edge length in mean input edges.
void BM_FindApex(benchmark::State& state) {
  const double length = static_cast<double>(state.range(0)) * MeanEdge();
  const auto edges = Edges(length);
  int64_t found = 0, asked = 0;
  for (auto _ : state) {
    const auto& [a, b] = edges[asked++ % edges.size()];
    const auto apex = Surface().FindApex(a, b, length, length);
    found += apex.has_value();
    benchmark::DoNotOptimize(apex);
  }
  state.counters["found"] = static_cast<double>(found) / static_cast<double>(asked);
}
BENCHMARK(BM_FindApex)->Arg(1)->Arg(2)->Arg(5);

void BM_Snap(benchmark::State& state) {
  const double length = static_cast<double>(state.range(0)) * MeanEdge();
  const auto edges = Edges(length);
  size_t i = 0;
  for (auto _ : state) {
    const auto& [a, b] = edges[i++ % edges.size()];
    benchmark::DoNotOptimize(Surface().Snap(a, b.position + 0.1 * length * b.normal));
  }
}
BENCHMARK(BM_Snap)->Arg(1)->Arg(4);

// Argument: edge length in mean input edges; an item is a face that the way passes.
void BM_TraceWay(benchmark::State& state) {
  const auto edges = Edges(static_cast<double>(state.range(0)) * MeanEdge());
  std::vector<WayPiece> way;
  size_t i = 0, pieces = 0;
  for (auto _ : state) {
    const auto& [a, b] = edges[i++ % edges.size()];
    Surface().TraceWay(a, b, way);
    pieces += way.size();
  }
  state.SetItemsProcessed(static_cast<int64_t>(pieces));
}
BENCHMARK(BM_TraceWay)->Arg(1)->Arg(4);

// Whether equilateral triangles keep a bound. Arguments: edge length in mean input edges, and the bound in hundredths of it, of which
// nothing exceeds 100; an item is a face of the input's size under them.
void BM_FindFarPlaces(benchmark::State& state) {
  const double ratio = static_cast<double>(state.range(0)), length = ratio * MeanEdge();
  std::vector<std::array<SourcePoint, 3>> triangles;
  for (const auto& [a, b] : Edges(length)) {
    if (const auto apex = Surface().FindApex(a, b, length, length)) triangles.push_back({b, a, *apex});
  }
  const double bound = 0.01 * static_cast<double>(state.range(1)) * length;
  std::vector<FarPlace> far;
  std::vector<DoubtfulPart> doubtful;
  size_t i = 0;
  for (auto _ : state) {
    const auto& t = triangles[i++ % triangles.size()];
    benchmark::DoNotOptimize(
        Surface().FindFarPlaces(t[0], {t[0].position, t[1].position, t[2].position}, bound, 0, far, &doubtful));
  }
  state.SetItemsProcessed(static_cast<int64_t>(ratio * ratio * static_cast<double>(state.iterations())));
}
BENCHMARK(BM_FindFarPlaces)->ArgNames({"edges", "bound"})->Args({2, 100})->Args({5, 100})->Args({5, 2});

}  // namespace
}  // namespace meshfront
