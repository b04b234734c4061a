#include <algorithm>
#include <cmath>

#include "core/surface/mesh_surface.h"
#include "tests/core/surface/surfaces.h"
#include "tests/support/matchers.h"
#include "tests/support/shapes.h"

namespace meshfront {
namespace {

using testing::IsOk;
using testing::SurfaceOf;

// With the same ideal length everywhere.
std::vector<CurvatureSample> Samples(const MeshSurface& surface, double length, bool with_thickness = true) {
  auto samples = surface.CurvatureSamples([&](double) { return length; }, with_thickness, Context{});
  EXPECT_THAT(samples, IsOk());
  return *samples;
}

TEST(Thickness, MeasuresThroughAThinSlab) {
  const auto surface = SurfaceOf(testing::ThinSlab(40, 0.04));
  int inside = 0;
  for (const CurvatureSample& sample : Samples(*surface, 0.2)) {
    if (std::max(std::abs(sample.position.x), std::abs(sample.position.y)) > 0.9) continue;
    EXPECT_NEAR(sample.sheet_distance, 0.04, 1e-9);
    ++inside;
  }
  EXPECT_GT(inside, 500);
}

TEST(Thickness, MeasuresTheGapBetweenTubes) {
  const auto surface = SurfaceOf(testing::ParallelTubes(0.01));
  double nearest = INFINITY;
  for (const CurvatureSample& sample : Samples(*surface, 0.3)) nearest = std::min(nearest, sample.sheet_distance);
  EXPECT_NEAR(nearest, 0.01, 0.004);
}

TEST(Thickness, MeasuresBetweenConcentricShells) {
  const auto surface = SurfaceOf(testing::ConcentricShells(4, 0.9));
  for (const CurvatureSample& sample : Samples(*surface, 0.4)) EXPECT_NEAR(sample.sheet_distance, 0.1, 0.01);
}

TEST(Thickness, SeesNothingBeyondTheLimit) {
  const auto surface = SurfaceOf(testing::ConcentricShells(4, 0.9));
  for (const CurvatureSample& sample : Samples(*surface, 0.1)) EXPECT_EQ(sample.sheet_distance, INFINITY);
  for (const CurvatureSample& sample : Samples(*surface, 0.4, false)) EXPECT_EQ(sample.sheet_distance, INFINITY);
}

TEST(Thickness, LeavesARoundLimbAndTheEdgesOfACubeToTheCurvature) {
  const auto sphere = SurfaceOf(testing::Icosphere(4, 0.1));
  for (const CurvatureSample& sample : Samples(*sphere, 1)) EXPECT_EQ(sample.sheet_distance, INFINITY);
  const auto cube = SurfaceOf(testing::Cube(12));
  for (const CurvatureSample& sample : Samples(*cube, 0.5)) EXPECT_EQ(sample.sheet_distance, INFINITY);
}

TEST(Thickness, IsFiniteOnlyAndPositiveOnARealMixOfShapes) {
  const auto surface = SurfaceOf(testing::GenusThree(48));
  for (const CurvatureSample& sample : Samples(*surface, 0.5)) EXPECT_GT(sample.sheet_distance, 0);
}

TEST(CurvatureSamples, HoldEveryVertexWhereTheMeshIsFine) {
  const auto surface = SurfaceOf(testing::Icosphere(3));
  EXPECT_EQ(Samples(*surface, 10).size(), surface->mesh().positions.size());
}

TEST(CurvatureSamples, FillLongEdgesAndFacesOfACoarseMesh) {
  // Edges of about 1.05, about ten wanted lengths: no point of the surface is farther from a sample than two of them. With eta 1.2
  // g rises between samples three lengths apart to 1.3 l/η, hardly above l.
  const auto surface = SurfaceOf(testing::Icosphere(0));
  const auto samples = Samples(*surface, 0.11);
  for (uint32_t f = 0; f < surface->mesh().triangles.size(); ++f) {
    const Vec3 centroid = surface->AtFace(FaceId(f), 1.0 / 3, 1.0 / 3).position;
    double nearest = INFINITY;
    for (const CurvatureSample& sample : samples) nearest = std::min(nearest, Distance(sample.position, centroid));
    EXPECT_LT(nearest, 0.22);
  }
}

TEST(CurvatureSamples, StayBoundedWhenTheWantedLengthIsTiny) {
  const auto surface = SurfaceOf(testing::Icosphere(5));
  const size_t vertices = surface->mesh().positions.size();
  EXPECT_LE(Samples(*surface, 1e-12).size(), 5 * vertices + 200000);
  EXPECT_LE(Samples(*surface, 0).size(), 5 * vertices + 200000);
}

TEST(CurvatureSamples, NeedTheCurvatureFirst) {
  auto surface = MeshSurface::Create(testing::Icosphere(2), Context{});
  ASSERT_THAT(surface, IsOk());
  EXPECT_THAT((*surface)->CurvatureSamples([](double) { return 1.0; }, false, Context{}),
              testing::StatusIs(absl::StatusCode::kFailedPrecondition, "curvature"));
}

TEST(CurvatureSamples, AreTheSameAtAnyNumberOfThreads) {
  const auto surface = SurfaceOf(testing::ParallelTubes());
  Context many;
  many.threads = 3;
  const auto one = Samples(*surface, 0.3);
  const auto three = surface->CurvatureSamples([](double) { return 0.3; }, true, many);
  ASSERT_THAT(three, IsOk());
  ASSERT_EQ(one.size(), three->size());
  for (size_t i = 0; i < one.size(); ++i) EXPECT_EQ(one[i].sheet_distance, (*three)[i].sheet_distance);
}

}  // namespace
}  // namespace meshfront
