#include "core/geometry/triangle.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace meshfront {
namespace {

Vec3 RandomPoint(std::mt19937& random) {
  std::uniform_real_distribution<double> uniform(-1, 1);
  const double x = uniform(random), y = uniform(random), z = uniform(random);
  return {x, y, z};
}

TEST(Triangle, RadiusRatioIsOneForEquilateralAndZeroForFlat) {
  const Vec3 a{1, 0, 0}, b{0, 1, 0}, c{0, 0, 1};
  EXPECT_NEAR(RadiusRatio(a, b, c), 1, 1e-15);
  EXPECT_EQ(RadiusRatio({0, 0, 0}, {1, 1, 1}, {2, 2, 2}), 0);
  EXPECT_EQ(RadiusRatio(a, a, a), 0);
  // 3-4-5: r = 1, R = 2.5.
  EXPECT_NEAR(RadiusRatio({0, 0, 0}, {3, 0, 0}, {0, 4, 0}), 0.8, 1e-15);
  EXPECT_NEAR(RadiusRatioOfSides(4, 3, 5), 0.8, 1e-15);
}

TEST(Triangle, RadiusRatioOfSidesIsZeroBeyondTheTriangleInequality) {
  EXPECT_EQ(RadiusRatioOfSides(1, 2, 3.5), 0);
  EXPECT_EQ(RadiusRatioOfSides(1, 2, 3), 0);
  EXPECT_EQ(RadiusRatioOfSides(0, 1, 1), 0);
}

TEST(Triangle, RadiusRatioOfPointsAndOfSidesAgree) {
  std::mt19937 random(1);
  for (int i = 0; i < 1000; ++i) {
    const Vec3 a = RandomPoint(random), b = RandomPoint(random), c = RandomPoint(random);
    EXPECT_NEAR(RadiusRatio(a, b, c), RadiusRatioOfSides(Distance(a, b), Distance(b, c), Distance(c, a)), 1e-12);
  }
}

TEST(Triangle, NeedlesKeepTheirRadiusRatioFromEveryCorner) {
  // A needle of base 1e-9 and length 1, far from the origin's grid: q = 16 A² / (abc (a + b + c)) = 2e-9.
  const Vec3 a{0, 0, 0}, b{0.6, 0.8, 0}, c{0.6 - 0.8e-9, 0.8 + 0.6e-9, 0};
  for (const double q : {RadiusRatio(a, b, c), RadiusRatio(b, c, a), RadiusRatio(c, a, b)})
    EXPECT_NEAR(q / 2e-9, 1, 1e-6);
}

TEST(Triangle, SquaredLongestSideIsTheSameFromEveryCorner) {
  const Vec3 a{0, 0, 0}, b{3, 0, 0}, c{0, 4, 0};
  EXPECT_EQ(SquaredLongestSide(a, b, c), 25);
  EXPECT_EQ(SquaredLongestSide(b, c, a), 25);
  EXPECT_EQ(SquaredLongestSide(c, a, b), 25);
}

TEST(Triangle, MinAngleIsTheSmallestOfThree) {
  EXPECT_NEAR(MinAngle({0, 0, 0}, {1, 0, 0}, {0, 1, 0}), std::numbers::pi / 4, 1e-15);
  EXPECT_NEAR(MinAngle({0, 0, 0}, {std::sqrt(3.0), 0, 0}, {0, 1, 0}), std::numbers::pi / 6, 1e-15);
  EXPECT_EQ(MinAngle({0, 0, 0}, {1, 0, 0}, {2, 0, 0}), 0);
}

TEST(Triangle, ClosestPointNamesItsRegion) {
  //      c
  //      | \        p above the inside, beyond each side, behind each corner
  //      a---b
  const Vec3 a{0, 0, 0}, b{2, 0, 0}, c{0, 2, 0};
  EXPECT_EQ(ClosestPointOnTriangle({0.5, 0.5, 3}, a, b, c).region, 0);
  EXPECT_EQ(ClosestPointOnTriangle({1, -1, 1}, a, b, c).region, 1);
  EXPECT_EQ(ClosestPointOnTriangle({2, 2, 1}, a, b, c).region, 2);
  EXPECT_EQ(ClosestPointOnTriangle({-1, 1, 1}, a, b, c).region, 3);
  EXPECT_EQ(ClosestPointOnTriangle({-1, -1, 1}, a, b, c).region, 4);
  EXPECT_EQ(ClosestPointOnTriangle({5, -1, 1}, a, b, c).region, 5);
  EXPECT_EQ(ClosestPointOnTriangle({-1, 5, 1}, a, b, c).region, 6);
  EXPECT_EQ(ClosestPointOnTriangle({1, -1, 1}, a, b, c).position, (Vec3{1, 0, 0}));
}

// No point of a fine grid over the triangle is closer than the answer, and the answer is where its weights say.
void ExpectClosest(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const TrianglePoint got = ClosestPointOnTriangle(p, a, b, c);
  const double distance = Distance(p, got.position);
  const double scale = Distance(a, b) + Distance(b, c) + Distance(p, a);
  const double* w = got.weights;
  EXPECT_NEAR(w[0] + w[1] + w[2], 1, 1e-12);
  for (int i = 0; i < 3; ++i) EXPECT_GE(w[i], -1e-12);
  EXPECT_LE(Distance(got.position, w[0] * a + w[1] * b + w[2] * c), 1e-12 * scale);
  constexpr int n = 24;
  for (int i = 0; i <= n; ++i) {
    for (int j = 0; i + j <= n; ++j) {
      const Vec3 q = (double(i) * a + double(j) * b + double(n - i - j) * c) / n;
      ASSERT_LE(distance, Distance(p, q) + 1e-12 * scale);
    }
  }
}

TEST(Triangle, ClosestPointBeatsAGridOfPointsOnRandomTriangles) {
  std::mt19937 random(2);
  for (int i = 0; i < 500; ++i) {
    const Vec3 p = 2 * RandomPoint(random), a = RandomPoint(random), b = RandomPoint(random), c = RandomPoint(random);
    ExpectClosest(p, a, b, c);
  }
}

TEST(Triangle, ClosestPointSurvivesSliversAndDegenerateTriangles) {
  std::mt19937 random(3);
  for (int i = 0; i < 1000; ++i) {
    const Vec3 p = 2 * RandomPoint(random), a = RandomPoint(random), b = RandomPoint(random);
    const double height = std::pow(10.0, -double(i % 20));
    const Vec3 c = Lerp(a, b, 0.1 * (i % 11)) + height * RandomPoint(random);
    ExpectClosest(p, a, b, c);
    ExpectClosest(p, c, a, b);
    ExpectClosest(p, a, a, b);
    ExpectClosest(p, a, b, a);
    ExpectClosest(p, a, a, a);
  }
}

}  // namespace
}  // namespace meshfront
