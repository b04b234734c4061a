#include "core/geometry/predicates.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace meshfront {
namespace {

int SignOf(__int128 x) { return x > 0 ? 1 : x < 0 ? -1 : 0; }

// Exact for integers below 2^40.
int IntegerOrient3d(const int64_t (&a)[3], const int64_t (&b)[3], const int64_t (&c)[3], const int64_t (&d)[3]) {
  __int128 u[3], v[3], w[3];
  for (int i = 0; i < 3; ++i) u[i] = b[i] - a[i], v[i] = c[i] - a[i], w[i] = d[i] - a[i];
  return SignOf(w[0] * (u[1] * v[2] - u[2] * v[1]) + w[1] * (u[2] * v[0] - u[0] * v[2]) +
                w[2] * (u[0] * v[1] - u[1] * v[0]));
}

Vec3 ToVec(const int64_t (&p)[3], double scale) {
  return {scale * double(p[0]), scale * double(p[1]), scale * double(p[2])};
}

TEST(Predicates, SignsFollowTheRightHand) {
  EXPECT_EQ(Orient2d({0, 0}, {1, 0}, {0, 1}), 1);
  EXPECT_EQ(Orient2d({0, 0}, {0, 1}, {1, 0}), -1);
  EXPECT_EQ(Orient2d({0, 0}, {1, 1}, {3, 3}), 0);
  EXPECT_EQ(Orient3d({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}), 1);
  EXPECT_EQ(Orient3d({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, -1}), -1);
  EXPECT_EQ(Orient3d({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {5, 7, 0}), 0);
}

TEST(Predicates, Orient3dEqualsIntegerArithmeticNearAndInPlanes) {
  // d is an integer combination of the others, then moved by at most one grid step: the filter can't tell, the integers
  // can.
  std::mt19937_64 random(1);
  int zeros = 0;
  for (int i = 0; i < 20000; ++i) {
    int64_t a[3], b[3], c[3], d[3];
    const int64_t range = int64_t{1} << (4 + i % 34);
    const auto draw = [&] { return int64_t(random() % uint64_t(2 * range)) - range; };
    const int64_t s = int64_t(random() % 5) - 2, t = int64_t(random() % 5) - 2;
    for (int k = 0; k < 3; ++k) {
      a[k] = draw(), b[k] = draw(), c[k] = draw();
      d[k] = a[k] + s * (b[k] - a[k]) + t * (c[k] - a[k]) + int64_t(random() % 40 == 0 ? random() % 3 : 1) - 1;
    }
    const int expected = IntegerOrient3d(a, b, c, d);
    zeros += expected == 0;
    const double scale = std::ldexp(1.0, i % 60 - 50);
    ASSERT_EQ(Orient3d(ToVec(a, scale), ToVec(b, scale), ToVec(c, scale), ToVec(d, scale)), expected);
    ASSERT_EQ(Orient3d(ToVec(b, scale), ToVec(a, scale), ToVec(c, scale), ToVec(d, scale)), -expected);
    ASSERT_EQ(Orient3d(ToVec(d, scale), ToVec(a, scale), ToVec(c, scale), ToVec(b, scale)), expected);
  }
  EXPECT_GT(zeros, 1000);
}

TEST(Predicates, Orient3dSeesOneUlpFarFromTheOrigin) {
  // The differences of these coordinates are not doubles.
  const Vec3 a{1e-20, 0, 0}, b{1, 1e-25, 0}, c{0, 1, 1e-30};
  for (const double z : {1e-60, -1e-60, 0.0}) {
    const Vec3 d = Vec3{1e-20, 0, z};
    EXPECT_EQ(Orient3d(a, b, c, d), (z > 0) - (z < 0));
  }
}

TEST(Predicates, Orient2dIsExactOnTheClassicGridOfUlps) {
  // Points one ulp apart against a line they almost lie on; the sign must be that of the exact integer value.
  const double ulp = 0x1p-53;
  for (int i = 0; i < 64; ++i) {
    for (int j = 0; j < 64; ++j) {
      const Vec2 p{0.5 + i * ulp, 0.5 + j * ulp};
      ASSERT_EQ(Orient2d(p, {12, 12}, {24, 24}), (j > i) - (j < i)) << i << " " << j;
    }
  }
}

TEST(Predicates, CollinearPointsAreFoundExactly) {
  EXPECT_TRUE(AreCollinear({0, 0, 0}, {0.1, 0.2, 0.3}, {0.2, 0.4, 0.6}));
  EXPECT_FALSE(AreCollinear({0, 0, 0}, {0.1, 0.2, 0.3}, {0.2, 0.4, std::nextafter(0.6, 1)}));
  EXPECT_TRUE(AreCollinear({1, 2, 3}, {1, 2, 3}, {4, 5, 6}));
}

}  // namespace
}  // namespace meshfront
