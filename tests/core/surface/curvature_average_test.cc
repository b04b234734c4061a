#include "core/surface/curvature_average.h"

#include <algorithm>
#include <atomic>
#include <memory>
#include <numeric>
#include <vector>

#include "gtest/gtest.h"
#include "tests/core/surface/surfaces.h"
#include "tests/support/shapes.h"

namespace meshfront {
namespace {

std::vector<double> Averaged(const MeshSurface& surface, double length, const Context& context = {}) {
  auto average = CurvatureAverage::Create(surface, context);
  EXPECT_TRUE(average.ok());
  auto curvatures = average->ForEdges([&](double) { return length; }, 1, context);
  EXPECT_TRUE(curvatures.ok());
  return *std::move(curvatures);
}

double Sum(absl::Span<const double> values) { return std::accumulate(values.begin(), values.end(), 0.0); }

// A sphere of radius 1 with 20,480 faces, edges of about 0.035, a little rough, and with one vertex in eighty pushed out.
TriangleMesh RoughSphere() {
  TriangleMesh mesh = testing::WithNoise(testing::Icosphere(5), 0.0005, 7);
  for (size_t v = 0; v < mesh.positions.size(); v += 80) mesh.positions[v] = 1.05 * mesh.positions[v];
  return mesh;
}

TEST(CurvatureAverage, LeavesASmoothSurfaceAsItIs) {
  const auto surface = testing::SurfaceOf(testing::Icosphere(4));
  const std::vector<double> averaged = Averaged(*surface, 0.5);
  for (size_t v = 0; v < averaged.size(); ++v) EXPECT_EQ(averaged[v], surface->vertex_curvatures()[v]);
}

TEST(CurvatureAverage, TakesPeaksOffForEdgesLongerThanTheInputs) {
  const auto surface = testing::SurfaceOf(RoughSphere());
  const auto own = surface->vertex_curvatures();
  const std::vector<double> averaged = Averaged(*surface, 0.2);
  const auto highest = std::max_element(own.begin(), own.end()) - own.begin();
  EXPECT_LT(averaged[highest], 0.8 * own[highest]);
  EXPECT_LT(*std::max_element(averaged.begin(), averaged.end()), 0.8 * own[highest]);
  for (size_t v = 0; v < averaged.size(); ++v) EXPECT_LE(averaged[v], own[v]);
}

TEST(CurvatureAverage, KeepsTheOwnWhereThereAreAsManyTriangles) {
  const auto surface = testing::SurfaceOf(RoughSphere());
  const std::vector<double> averaged = Averaged(*surface, 0.03);
  for (size_t v = 0; v < averaged.size(); ++v) EXPECT_EQ(averaged[v], surface->vertex_curvatures()[v]);
}

// The surface keeps the rings that it was fitted with; they are not looked for twice.
TEST(CurvatureAverage, TakesTheRingsOfTheSurface) {
  const TriangleMesh mesh = testing::Icosphere(3);
  auto surface = *MeshSurface::Create(mesh, Context{});
  EXPECT_EQ(surface->vertex_rings(), nullptr);
  ASSERT_TRUE(surface->ComputeCurvature(Context{}).ok());
  const std::shared_ptr<const VertexRings> rings = surface->vertex_rings();
  ASSERT_NE(rings, nullptr);
  const VertexRings expected = *CreateVertexRings(surface->mesh(), surface->adjacency(), Context{});
  EXPECT_EQ(rings->begin, expected.begin);
  EXPECT_EQ(rings->neighbours, expected.neighbours);
  const long before = rings.use_count();
  const auto average = CurvatureAverage::Create(*surface, Context{});
  ASSERT_TRUE(average.ok());
  EXPECT_EQ(rings.use_count(), before + 1);
}

// A search for a count needs that: passes are whole, the wish for them is not.
TEST(CurvatureAverage, ChangesLittleWhenTheEdgesDo) {
  const auto surface = testing::SurfaceOf(RoughSphere());
  double last = Sum(Averaged(*surface, 0.04));
  for (double length = 0.041; length < 0.12; length += 0.001) {
    const double sum = Sum(Averaged(*surface, length));
    EXPECT_NEAR(sum / last, 1, 0.02) << length;
    last = sum;
  }
}

// The last answer is kept, and changes nothing.
TEST(CurvatureAverage, DoesNotDependOnWhatWasAskedBefore) {
  const auto surface = testing::SurfaceOf(RoughSphere());
  auto average = CurvatureAverage::Create(*surface, Context{});
  ASSERT_TRUE(average.ok());
  for (const double length : {0.1, 0.25, 0.22, 0.24, 0.1, 0.03, 0.15, 0.4}) {
    const auto again = average->ForEdges([&](double) { return length; }, 1, Context{});
    ASSERT_TRUE(again.ok());
    EXPECT_EQ(*again, Averaged(*surface, length)) << length;
  }
}

// Polynomials of means may fall below all that they are means of.
TEST(CurvatureAverage, IsNowhereNegative) {
  const auto surface = testing::SurfaceOf(RoughSphere());
  for (const double length : {0.1, 0.2, 0.4, 1.0, 3.0}) {
    for (const double curvature : Averaged(*surface, length)) EXPECT_GE(curvature, 0) << length;
  }
}

// However much is averaged, what is narrower than the disk goes, and the mean stays.
TEST(CurvatureAverage, AveragesOverWiderDisksForLongerEdges) {
  const auto surface = testing::SurfaceOf(RoughSphere());
  double last = 1e300;
  for (const double length : {0.05, 0.1, 0.2, 0.4}) {
    const std::vector<double> averaged = Averaged(*surface, length);
    const double mean = Sum(averaged) / static_cast<double>(averaged.size());
    double variance = 0;
    for (const double curvature : averaged) variance += (curvature - mean) * (curvature - mean);
    EXPECT_LT(variance, 1.001 * last) << length;
    last = variance;
  }
}

TEST(CurvatureAverage, IsTheSameAtAnyNumberOfThreadsAndCanBeStopped) {
  const auto surface = testing::SurfaceOf(RoughSphere());
  Context many;
  many.threads = 3;
  EXPECT_EQ(Averaged(*surface, 0.2), Averaged(*surface, 0.2, many));
  auto average = CurvatureAverage::Create(*surface, Context{});
  ASSERT_TRUE(average.ok());
  const std::atomic<bool> stop = true;
  Context stopped;
  stopped.stop = &stop;
  EXPECT_EQ(average->ForEdges([](double) { return 0.2; }, 1, stopped).status().code(), absl::StatusCode::kCancelled);
}

}  // namespace
}  // namespace meshfront
