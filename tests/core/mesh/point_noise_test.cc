// How far points lie off their surface, of shapes that are known.
#include "core/mesh/point_noise.h"

#include <cmath>
#include <random>

#include "gtest/gtest.h"
#include "tests/support/shapes.h"

namespace meshfront {
namespace {

TriangleMesh NoisySphere(size_t count, double deviation) {
  TriangleMesh points = testing::Sampled(testing::Icosphere(4), count);
  std::mt19937_64 random(1);
  std::normal_distribution<double> off(1, deviation);
  for (Vec3& x : points.positions) x = off(random) * Normalized(x);
  return points;
}

TEST(PointNoise, IsWhatThePointsAreOff) {
  for (const double deviation : {0.02, 0.04}) {
    const PointNoise noise = MeasurePointNoise(NoisySphere(8000, deviation).positions);
    EXPECT_NEAR(noise.deviation, deviation, 0.15 * deviation);
    EXPECT_NEAR(noise.spacing, std::sqrt(4 * M_PI / 8000), 0.2 * std::sqrt(4 * M_PI / 8000));
    EXPECT_GT(noise.neighbours, 12u);
  }
}

TEST(PointNoise, IsNoneAtEdgesAndThinPlates) {
  for (const TriangleMesh& shape : {testing::Icosphere(4), testing::Cube(8), testing::ThinSlab(40, 0.08)}) {
    const PointNoise noise = MeasurePointNoise(testing::Sampled(shape, 12000).positions);
    EXPECT_EQ(noise.neighbours, 12u);
    EXPECT_LT(noise.deviation, 0.1 * noise.spacing);
  }
}

}  // namespace
}  // namespace meshfront
