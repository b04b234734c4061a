// Building the guidance field and asking it. Samples lie on a bumpy sphere, in the order of a scan, with lengths from the
// bumps' curvature: about 6 % survive pruning, as on scanned models.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "benchmark/benchmark.h"
#include "core/guidance/guidance_field.h"

namespace meshfront {
namespace {

std::vector<SizingSample> BumpySphere(int count) {
  std::vector<SizingSample> samples;
  const int rows = static_cast<int>(std::sqrt(count / 2.0)), columns = count / rows;
  for (int i = 0; i < rows * columns; ++i) {
    const double theta = std::numbers::pi * (i / columns + 0.5) / rows;
    const double phi = 2 * std::numbers::pi * (i % columns) / columns;
    const double wave = std::sin(7 * theta) * std::sin(9 * phi) + 0.5 * std::sin(23 * theta + 11 * phi);
    const double radius = 1 + 0.03 * wave;
    const double curvature = 1 + 14 * std::abs(wave) + 3 * std::sin(61 * theta) * std::sin(53 * phi);
    samples.push_back(
        {{radius * std::sin(theta) * std::cos(phi), radius * std::sin(theta) * std::sin(phi), radius * std::cos(theta)},
         IdealLength(0.5, std::max(0.05, curvature))});
  }
  return samples;
}

GuidanceField FieldOf(std::vector<SizingSample> samples) {
  return *GuidanceField::Create(std::move(samples), {1.2, 1e-4, 1}, {});
}

void BM_CreateField(benchmark::State& state) {
  std::vector<SizingSample> samples = BumpySphere(state.range(0));
  if (state.range(1)) std::shuffle(samples.begin(), samples.end(), std::mt19937_64(1));
  size_t kept = 0;
  for (auto _ : state) kept = FieldOf(samples).kept_samples().size();
  state.counters["kept"] = static_cast<double>(kept);
  state.counters["per_sample"] = benchmark::Counter(static_cast<double>(state.iterations() * samples.size()),
                                                    benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}
BENCHMARK(BM_CreateField)
    ->ArgNames({"samples", "shuffled"})
    ->Args({35000, 0})
    ->Args({35000, 1})
    ->Args({134000, 0})
    ->Args({134000, 1})
    ->Unit(benchmark::kMillisecond);

// Queries at the samples themselves: in the order of the scan, or shuffled; without or with the bound from the last one.
void BM_At(benchmark::State& state) {
  std::vector<SizingSample> points = BumpySphere(state.range(0));
  const GuidanceField field = FieldOf(points);
  if (state.range(1)) std::shuffle(points.begin(), points.end(), std::mt19937_64(1));
  const double slope = 1 - 1 / field.eta();
  size_t i = 0;
  double last = field.options().max_length;
  Vec3 from = points[0].position;
  for (auto _ : state) {
    const Vec3& x = points[i].position;
    last = state.range(2) ? field.At(x, last + slope * Distance(from, x)) : field.At(x);
    benchmark::DoNotOptimize(last);
    from = x;
    i = i + 1 == points.size() ? 0 : i + 1;
  }
}
BENCHMARK(BM_At)
    ->ArgNames({"samples", "shuffled", "bounded"})
    ->Args({35000, 0, 0})
    ->Args({35000, 0, 1})
    ->Args({35000, 1, 0})
    ->Args({134000, 0, 0})
    ->Args({134000, 0, 1})
    ->Args({134000, 1, 0});

// The same in runs of `run` places, each around the first of them; an item is a place.
void BM_AtInPatches(benchmark::State& state) {
  const std::vector<SizingSample> points = BumpySphere(state.range(0));
  const GuidanceField field = FieldOf(points);
  const size_t run = static_cast<size_t>(state.range(1));
  FieldPatch patch(field);
  size_t i = 0;
  for (auto _ : state) {
    const Vec3& center = points[i].position;
    patch.Cover(center, Distance(center, points[i + run - 1].position), field.options().max_length);
    for (size_t k = 0; k < run; ++k) benchmark::DoNotOptimize(patch.At(points[i + k].position));
    i = i + 2 * run > points.size() ? 0 : i + run;
  }
  state.SetItemsProcessed(state.iterations() * static_cast<int64_t>(run));
}
BENCHMARK(BM_AtInPatches)->ArgNames({"samples", "run"})->Args({35000, 4})->Args({134000, 4})->Args({134000, 8});

// Other lengths for the samples of a field, as a search for a count asks for them.
void BM_WithLengths(benchmark::State& state) {
  const GuidanceField field = FieldOf(BumpySphere(state.range(0)));
  std::vector<double> lengths;
  for (const SizingSample& s : field.kept_samples()) lengths.push_back(1.1 * s.ideal_length);
  for (auto _ : state) benchmark::DoNotOptimize(field.WithLengths(lengths, 1).kept_samples().data());
  state.SetItemsProcessed(state.iterations() * static_cast<int64_t>(lengths.size()));
}
BENCHMARK(BM_WithLengths)->ArgName("samples")->Arg(35000)->Arg(134000);

}  // namespace
}  // namespace meshfront
