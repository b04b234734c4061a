#include "core/surface/mls_samples.h"

#include <algorithm>
#include <cmath>

#include "gtest/gtest.h"
#include "tests/support/matchers.h"
#include "tests/support/shapes.h"

namespace meshfront::testing {
namespace {

std::unique_ptr<MlsSamples> SamplesOf(const TriangleMesh& mesh) {
  const TriangleMesh points = Sampled(mesh, 2000);
  absl::StatusOr<std::unique_ptr<MlsSamples>> samples =
      MlsSamples::Create(points.positions, points.normals, 4, {}, 12, MlsWeights::kNarrowAtEdges);
  EXPECT_THAT(samples, IsOk());
  return samples.ok() ? *std::move(samples) : nullptr;
}

// Two sheets that face each other's way, far apart: no place near the one that faces up has a patch that faces down.
TEST(MlsSamples, KeepsToAPatchWhereNoneNearByFacesTheSameWay) {
  const auto samples = SamplesOf(Joined(Sheet(4), Moved(Reversed(Sheet(4)), {0, 0, 9})));
  ASSERT_NE(samples, nullptr);
  const uint32_t own = samples->PatchOf(samples->NearestLike({0, 0, 0}, {0, 0, 1}));
  EXPECT_EQ(samples->PatchNear({0, 0, 0.01}, {0, 0, -1}, own), own);
  const uint32_t beside = samples->PatchNear({0.9, 0.9, 0.01}, {0, 0, 1}, own);
  EXPECT_NE(beside, own);
  EXPECT_EQ(beside, samples->PatchOf(samples->NearestLike({0.9, 0.9, 0.01}, {0, 0, 1})));
}

TEST(MlsSamples, TakeMoreSamplesWithTheSupportsOfThoseBeside) {
  const auto samples = SamplesOf(Sheet(4));
  ASSERT_NE(samples, nullptr);
  const auto wide = samples->Widened({}, 1.5, 16, {});
  ASSERT_THAT(wide, IsOk());
  const auto more = (*wide)->With({{0.5, 0.5, 0}, {-0.5, 0.5, 0}}, {{0, 0, 1}, {0, 0, 1}}, {});
  ASSERT_THAT(more, IsOk());
  EXPECT_EQ((*more)->samples().size(), samples->samples().size() + 2);
  for (uint32_t i = 0; i < (*more)->samples().size(); ++i)
    EXPECT_NEAR((*more)->samples()[i].support, 6 * (*more)->SpacingAt(i), 1e-9);
}

double RadiusPerSupport(const MlsSample& s) { return 1 / (std::sqrt(s.inverse_squared_radius) * s.support); }

// A roof of two planes that meet at a right angle along the y axis: weights are narrow along the ridge, and nowhere else.
TEST(MlsSamples, HaveNarrowWeightsAtASharpEdgeOnly) {
  const auto samples = SamplesOf(HeightField(8, [](double x, double) { return -std::abs(x); }));
  ASSERT_NE(samples, nullptr);
  int narrow = 0;
  for (const MlsSample& s : samples->samples()) {
    const double away = std::abs(s.position.x) * std::sqrt(2.0) / (s.support / 4);  // spacings
    if (away < 0.5) {
      EXPECT_LT(RadiusPerSupport(s), 0.75);
    }
    if (away > 5) {
      EXPECT_NEAR(RadiusPerSupport(s), 1, 1e-9);
    }
    narrow += away < 0.5;
  }
  EXPECT_GT(narrow, 20);
}

// Points that lie off a sphere all over are no edges.
TEST(MlsSamples, HaveWideWeightsInNoise) {
  TriangleMesh points = Sampled(Icosphere(4), 4000);
  points = WithNoise(points, 0.6 * std::sqrt(4 * M_PI / 4000), 3);
  const auto samples = MlsSamples::Create(points.positions, points.normals, 4, {}, 12, MlsWeights::kNarrowAtEdges);
  ASSERT_THAT(samples, IsOk());
  int narrow = 0;
  for (const MlsSample& s : (*samples)->samples()) narrow += RadiusPerSupport(s) < 0.99;
  EXPECT_LE(narrow, 40);
}

// Where supports were widened they stay as wide.
TEST(MlsSamples, HaveWideWeightsWhereTheyWereWidened) {
  const auto samples = SamplesOf(HeightField(8, [](double x, double) { return -std::abs(x); }));
  ASSERT_NE(samples, nullptr);
  const auto wide = samples->Widened({}, 1.01, 16, {});
  ASSERT_THAT(wide, IsOk());
  for (const MlsSample& s : (*wide)->samples()) EXPECT_NEAR(RadiusPerSupport(s), 1, 1e-9);
}

// Where the surface is to be as round as without narrow weights, they are wide again, there only.
TEST(MlsSamples, AreRoundedAroundPlaces) {
  const auto samples = SamplesOf(HeightField(8, [](double x, double) { return -std::abs(x); }));
  ASSERT_NE(samples, nullptr);
  const Vec3 place{0, -0.8, 0};
  const auto rounded = samples->Rounded({&place, 1}, {});
  ASSERT_THAT(rounded, IsOk());
  ASSERT_NE(*rounded, nullptr);
  const auto sharpest_near = [](const MlsSamples& all, const Vec3& x) {
    double sharpest = 0;
    for (const MlsSample& s : all.samples())
      if (Distance(s.position, x) < 0.5 * s.support) sharpest = std::max(sharpest, s.Sharpness());
    return sharpest;
  };
  EXPECT_GT(sharpest_near(*samples, place), 0.9);
  EXPECT_LT(sharpest_near(**rounded, place), 0.1);
  EXPECT_GT(sharpest_near(**rounded, {0, 0.8, 0}), 0.9);
  const auto all = samples->Rounded({}, {});
  ASSERT_THAT(all, IsOk());
  ASSERT_NE(*all, nullptr);
  EXPECT_EQ(sharpest_near(**all, {0, 0.8, 0}), 0);
  EXPECT_EQ((*rounded)->samples().size(), samples->samples().size());
  for (const MlsSample& s : (*rounded)->samples())
    EXPECT_NEAR(s.support, 4 * (*rounded)->SpacingAt((*rounded)->NearestLike(s.position, s.normal)), 1e-9);
}

TEST(MlsSamples, HaveNothingToRoundWhereNoWeightIsNarrow) {
  const auto samples = SamplesOf(Sheet(4));
  ASSERT_NE(samples, nullptr);
  const Vec3 place{0, 0, 0};
  const auto rounded = samples->Rounded({&place, 1}, {});
  ASSERT_THAT(rounded, IsOk());
  EXPECT_EQ(*rounded, nullptr);
}

}  // namespace
}  // namespace meshfront::testing
