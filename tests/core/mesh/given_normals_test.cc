// When normals that come with points are worth less than what the points tell, and what becomes of them.
#include "core/mesh/given_normals.h"

#include <cmath>
#include <random>

#include "gtest/gtest.h"
#include "tests/support/matchers.h"
#include "tests/support/shapes.h"

namespace meshfront::testing {
namespace {

TriangleMesh WithNormalNoise(TriangleMesh points, double deviation) {
  std::mt19937_64 random(1);
  std::normal_distribution<double> off(0, deviation);
  for (Vec3& n : points.normals) n = Normalized(n + Vec3{off(random), off(random), off(random)});
  return points;
}

NormalNoise NoiseOf(const TriangleMesh& points) { return MeasureNormalNoise(points, PointTree(points.positions), 14); }

TEST(GivenNormals, AreWorseThanPlanesWhereTheyAreNoise) {
  const TriangleMesh points = Sampled(Torus(1, 0.4, 60, 24), 8000);
  EXPECT_TRUE(NoiseOf(WithNormalNoise(points, 0.5)).AreWorseThanPlanes());
  EXPECT_FALSE(NoiseOf(WithNormalNoise(points, 0.05)).AreWorseThanPlanes());
}

// At edges, on points that lie off the surface, and on few points of a bent shape it is the planes that are wrong.
TEST(GivenNormals, AreBetterThanPlanesWhereThoseAreWrong) {
  EXPECT_FALSE(NoiseOf(Sampled(Cube(8), 300)).AreWorseThanPlanes());
  EXPECT_FALSE(NoiseOf(Sampled(Torus(1, 0.4, 60, 24), 200)).AreWorseThanPlanes());
  EXPECT_FALSE(NoiseOf(WithNoise(Sampled(Icosphere(4), 8000), 0.04, 1)).AreWorseThanPlanes());
}

TEST(GivenNormals, KeepTheirSidesWhenPlanesReplaceThem) {
  TriangleMesh points = WithNormalNoise(Sampled(Icosphere(4), 4000), 0.3);
  points.normals[5] = {};
  const TriangleMesh before = points;
  ASSERT_THAT(ReplaceByPlaneNormals(points, PointTree(points.positions), 14, {}), IsOk());
  for (size_t i = 0; i < points.normals.size(); ++i) {
    if (i == 5) continue;
    EXPECT_GE(Dot(points.normals[i], before.normals[i]), 0);
    EXPECT_GT(std::abs(Dot(points.normals[i], Normalized(points.positions[i]))), 0.98);
  }
  EXPECT_EQ(points.normals[5], Vec3{});
}

}  // namespace
}  // namespace meshfront::testing
