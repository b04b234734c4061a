// Reading and writing, from and to memory: a torus of 100k triangles in every format.
#include <cmath>
#include <numbers>
#include <string>

#include "benchmark/benchmark.h"
#include "core/io/mesh_io.h"

namespace meshfront {
namespace {

TriangleMesh Torus(uint32_t around, uint32_t along) {
  TriangleMesh mesh;
  for (uint32_t i = 0; i < around; ++i) {
    for (uint32_t j = 0; j < along; ++j) {
      const double u = 2 * std::numbers::pi * i / around, v = 2 * std::numbers::pi * j / along,
                   r = 1 + 0.3 * std::cos(v);
      mesh.positions.push_back({r * std::cos(u), r * std::sin(u), 0.3 * std::sin(v)});
      auto id = [&](uint32_t di, uint32_t dj) { return VertexId((i + di) % around * along + (j + dj) % along); };
      mesh.triangles.push_back({id(0, 0), id(1, 0), id(1, 1)});
      mesh.triangles.push_back({id(0, 0), id(1, 1), id(0, 1)});
    }
  }
  return mesh;
}

void Count(benchmark::State& state, const TriangleMesh& mesh, size_t bytes) {
  const auto runs = static_cast<int64_t>(state.iterations());
  state.SetLabel(std::string(FormatName(static_cast<Format>(state.range(0)))));
  state.SetBytesProcessed(runs * static_cast<int64_t>(bytes));
  state.counters["vertices/s"] = benchmark::Counter(
      static_cast<double>(runs) * static_cast<double>(mesh.positions.size()), benchmark::Counter::kIsRate);
}

void BM_Read(benchmark::State& state) {
  const Format format = static_cast<Format>(state.range(0));
  TriangleMesh mesh = Torus(500, 100);
  if (format == Format::kXyz) mesh.triangles = {};
  const std::string bytes = *FormatMesh(mesh, format);
  const absl::Span<const uint8_t> span(reinterpret_cast<const uint8_t*>(bytes.data()), bytes.size());
  for (auto _ : state) {
    const auto read = ReadMesh(span, format, "benchmark");
    if (!read.ok()) state.SkipWithError(std::string(read.status().message()).c_str());
    benchmark::DoNotOptimize(read);
  }
  Count(state, mesh, bytes.size());
}

void BM_Write(benchmark::State& state) {
  const Format format = static_cast<Format>(state.range(0));
  TriangleMesh mesh = Torus(500, 100);
  if (format == Format::kXyz) mesh.triangles = {};
  size_t size = 0;
  for (auto _ : state) {
    const auto bytes = FormatMesh(mesh, format);
    if (!bytes.ok())
      state.SkipWithError(std::string(bytes.status().message()).c_str());
    else
      size = bytes->size();
  }
  Count(state, mesh, size);
}

constexpr int kFirst = static_cast<int>(Format::kOff), kLast = static_cast<int>(Format::kXyz);
BENCHMARK(BM_Read)->DenseRange(kFirst, kLast)->Unit(benchmark::kMillisecond);
BENCHMARK(BM_Write)->DenseRange(kFirst, kLast)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace meshfront
