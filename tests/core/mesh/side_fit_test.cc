// One-sided fits of samples, and the places where they meet.
#include "core/mesh/side_fit.h"

#include <cmath>
#include <numeric>
#include <random>
#include <vector>

#include "gtest/gtest.h"

namespace meshfront {
namespace {

struct Samples {
  std::vector<Vec3> positions, normals;
  std::vector<uint32_t> all;
};

// Over the half disc of radius 1 where x ≥ 0.
Samples HalfDisc(size_t count, double bend, double deviation) {
  Samples samples;
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> place(-1, 1);
  std::normal_distribution<double> off(0, 1);
  while (samples.positions.size() < count) {
    const double x = std::abs(place(random)), y = place(random);
    if (x * x + y * y > 1) continue;
    samples.positions.push_back({x, y, bend * (x * x - 0.5 * x * y) + deviation * off(random)});
    samples.normals.push_back({0, 0, 1});
  }
  samples.all.resize(count);
  std::iota(samples.all.begin(), samples.all.end(), 0u);
  return samples;
}

SideFit FitAt(const Vec3& x, const Samples& samples) {
  return FitSide(x, 1, samples.positions, samples.normals, samples.all);
}

TEST(SideFit, GoesOnBeyondTheSamplesAsTheyBend) {
  const SideFit fit = FitAt({0, 0, 0}, HalfDisc(60, 0.3, 0));
  for (const double x : {-0.2, 0.0, 0.5}) EXPECT_NEAR(fit.HeightAt({x, 0.1, 0.3 * (x * x - 0.05 * x)}), 0, 1e-3);
}

TEST(SideFit, IsAPlaneWhereTheBendIsNoise) {
  const SideFit fit = FitAt({0, 0, 0}, HalfDisc(60, 0, 0.05));
  EXPECT_EQ(fit.c[3], 0);
  EXPECT_EQ(fit.c[4], 0);
  EXPECT_EQ(fit.c[5], 0);
  EXPECT_NEAR(fit.HeightAt({-0.3, 0, 0}), 0, 0.06);
}

SideFit PlaneThrough(const Vec3& place, const Vec3& normal) {
  Samples samples;
  const Vec3 u = Normalized(Cross(normal, {0.3, 0.5, 0.7})), v = Cross(Normalized(normal), u);
  for (int i = 0; i < 8; ++i) {
    samples.positions.push_back(place + 0.5 * (std::cos(i) * u + std::sin(2 * i) * v));
    samples.normals.push_back(Normalized(normal));
    samples.all.push_back(static_cast<uint32_t>(i));
  }
  return FitAt(place, samples);
}

TEST(SideFit, MeetsOthersInEdgesAndCorners) {
  const SideFit x = PlaneThrough({1, 0, 0}, {1, 0, 0}), y = PlaneThrough({0, 1, 0}, {0, 1, 0}),
                z = PlaneThrough({0, 0, 1}, {0, 0, 1});
  const std::array<const SideFit*, 3> all = {&x, &y, &z};
  const auto corner = FindMeeting(all, {0.8, 0.7, 0.9}, 1);
  ASSERT_TRUE(corner.has_value());
  EXPECT_LT(Distance(*corner, {1, 1, 1}), 1e-9);
  const auto edge = FindMeeting(absl::MakeConstSpan(all).subspan(0, 2), {0.8, 0.7, 0.9}, 1);
  ASSERT_TRUE(edge.has_value());
  EXPECT_LT(Distance(*edge, {1, 1, 0.9}), 1e-9);  // the nearest one
}

TEST(SideFit, MeetsNothingParallelOrFar) {
  const SideFit a = PlaneThrough({0, 0, 0}, {0, 0, 1}), b = PlaneThrough({0, 0, 0.1}, {0, 0.02, 1}),
                c = PlaneThrough({5, 0, 0}, {1, 0, 0});
  const std::array<const SideFit*, 2> parallel = {&a, &b}, far = {&a, &c};
  EXPECT_FALSE(FindMeeting(parallel, {0, 0, 0}, 100).has_value());
  EXPECT_FALSE(FindMeeting(far, {0, 0, 0}, 1).has_value());
}

}  // namespace
}  // namespace meshfront
