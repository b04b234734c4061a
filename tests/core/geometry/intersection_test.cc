#include "core/geometry/intersection.h"

#include <gtest/gtest.h>

#include <numeric>
#include <random>
#include <vector>

namespace meshfront {
namespace {

// A fraction of two integers: enough for triangles with corners on a small grid.
struct Rational {
  __int128 n = 0, d = 1;
  Rational(__int128 numerator, __int128 denominator = 1) : n(numerator), d(denominator) {
    if (d < 0) n = -n, d = -d;
  }
  friend bool operator<=(const Rational& a, const Rational& b) { return a.n * b.d <= b.n * a.d; }
  friend bool operator<(const Rational& a, const Rational& b) { return a.n * b.d < b.n * a.d; }
};

using P = std::array<int64_t, 3>;
P Minus(const P& a, const P& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
P CrossOf(const P& a, const P& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
int64_t DotOf(const P& a, const P& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

// Whether two triangles have a common point besides the given corners and the segment between them, by another way than
// the code: separating axes. Two convex sets are disjoint iff some direction among normals, in-plane normals of sides
// and cross products of sides separates them (strictly). For shared corners the corner is cut off: the common points
// form a convex set, so it suffices to look whether the triangles, shrunk towards their other corners, still meet for
// all small cuts; on an integer grid a cut at 1/1000 is small enough.
bool Separated(const std::vector<P>& a, const std::vector<P>& b) {
  std::vector<P> axes;
  std::vector<P> a_sides, b_sides;
  for (size_t i = 0; i < a.size(); ++i) a_sides.push_back(Minus(a[(i + 1) % a.size()], a[i]));
  for (size_t i = 0; i < b.size(); ++i) b_sides.push_back(Minus(b[(i + 1) % b.size()], b[i]));
  const P na = CrossOf(a_sides[0], a_sides[1]), nb = CrossOf(b_sides[0], b_sides[1]);
  axes = {na, nb};
  for (const P& e : a_sides) axes.push_back(CrossOf(na, e));
  for (const P& e : b_sides) axes.push_back(CrossOf(nb, e));
  for (const P& e : a_sides) {
    for (const P& f : b_sides) axes.push_back(CrossOf(e, f));
  }
  for (const P& axis : axes) {
    if (axis == P{0, 0, 0}) continue;
    int64_t a_low = INT64_MAX, a_high = INT64_MIN, b_low = INT64_MAX, b_high = INT64_MIN;
    for (const P& p : a) a_low = std::min(a_low, DotOf(axis, p)), a_high = std::max(a_high, DotOf(axis, p));
    for (const P& p : b) b_low = std::min(b_low, DotOf(axis, p)), b_high = std::max(b_high, DotOf(axis, p));
    if (a_high < b_low || b_high < a_low) return true;
  }
  return false;
}

void Fill(Vec3 (&out)[3], const std::vector<P>& t) {
  for (int i = 0; i < 3; ++i) out[i] = {double(t[i][0]), double(t[i][1]), double(t[i][2])};
}

bool HasArea(const std::vector<P>& t) { return CrossOf(Minus(t[1], t[0]), Minus(t[2], t[0])) != P{0, 0, 0}; }

std::vector<P> RandomTriangle(std::mt19937& random, int range) {
  std::vector<P> t(3);
  for (P& p : t) {
    for (int64_t& x : p) x = int64_t(random() % uint32_t(range));
  }
  return t;
}

TEST(TrianglesIntersect, AgreesWithSeparatingAxesOnAGrid) {
  std::mt19937 random(1);
  int meeting = 0, apart = 0;
  for (int i = 0; i < 40000; ++i) {
    const std::vector<P> s = RandomTriangle(random, 2 + i % 6), t = RandomTriangle(random, 2 + i % 6);
    Vec3 a[3], b[3];
    Fill(a, s), Fill(b, t);
    const bool expected = HasArea(s) && HasArea(t) && !Separated(s, t);
    ASSERT_EQ(TrianglesIntersect(a, b), expected) << i;
    ASSERT_EQ(TrianglesIntersect(b, a), expected) << i;
    (expected ? meeting : apart)++;
  }
  EXPECT_GT(meeting, 3000);
  EXPECT_GT(apart, 3000);
}

TEST(TrianglesIntersect, WithASharedCornerAgreesWithTriangleThatEndsBeforeIt) {
  // Cut the shared corner off one triangle, a thousandth of the way: what remains meets the other iff they have more in
  // common, as common points reach up to where one triangle ends, which on this grid is farther away.
  std::mt19937 random(2);
  int meeting = 0, apart = 0;
  for (int i = 0; i < 40000; ++i) {
    std::vector<P> s = RandomTriangle(random, 3 + i % 4), t = RandomTriangle(random, 3 + i % 4);
    t[i % 3] = s[0];
    if (!HasArea(s) || !HasArea(t)) continue;
    Vec3 a[3], b[3];
    Fill(a, s), Fill(b, t);
    std::vector<P> large_t;
    for (const P& p : t) large_t.push_back({1000 * p[0], 1000 * p[1], 1000 * p[2]});
    std::vector<P> cut;
    for (int k = 1; k < 3; ++k) {
      cut.push_back({1000 * s[k][0], 1000 * s[k][1], 1000 * s[k][2]});
    }
    for (int k = 2; k > 0; --k) {
      const P d = Minus(s[k], s[0]);
      cut.push_back({1000 * s[0][0] + d[0], 1000 * s[0][1] + d[1], 1000 * s[0][2] + d[2]});
    }
    const bool expected = !Separated(cut, large_t);
    SharedCorners shared;
    shared.in_b[0] = i % 3, shared.count = 1;
    ASSERT_EQ(TrianglesIntersect(a, b, shared), expected) << i;
    (expected ? meeting : apart)++;
  }
  EXPECT_GT(meeting, 1000);
  EXPECT_GT(apart, 1000);
}

TEST(TrianglesIntersect, NeighboursAcrossAnEdgeMeetOnlyWhenFoldedFlat) {
  const Vec3 a[3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  const SharedCorners shared =
      SharedCornersOf({VertexId(0), VertexId(1), VertexId(2)}, {VertexId(1), VertexId(0), VertexId(3)});
  EXPECT_EQ(shared.count, 2);
  const Vec3 flat[3] = {{1, 0, 0}, {0, 0, 0}, {0.5, -1, 0}};
  EXPECT_FALSE(TrianglesIntersect(a, flat, shared));
  const Vec3 folded[3] = {{1, 0, 0}, {0, 0, 0}, {0.9, 0.9, 0}};
  EXPECT_TRUE(TrianglesIntersect(a, folded, shared));
  const Vec3 almost[3] = {{1, 0, 0}, {0, 0, 0}, {0.9, 0.9, 1e-30}};
  EXPECT_FALSE(TrianglesIntersect(a, almost, shared));
}

TEST(TrianglesIntersect, DuplicatesCountAndDegenerateTrianglesDoNot) {
  const Vec3 a[3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  const std::array<VertexId, 3> ids = {VertexId(0), VertexId(1), VertexId(2)};
  EXPECT_TRUE(TrianglesIntersect(a, a, SharedCornersOf(ids, ids)));
  const Vec3 needle[3] = {{0.1, 0.1, -1}, {0.1, 0.1, 1}, {0.1, 0.1, 0.5}};
  EXPECT_FALSE(TrianglesIntersect(a, needle));
}

TEST(TrianglesIntersect, TouchingCountsAndOneUlpApartDoesNot) {
  const Vec3 a[3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  const Vec3 touching[3] = {{0.25, 0.25, 0}, {0.25, 0.25, 1}, {1, 1, 1}};
  EXPECT_TRUE(TrianglesIntersect(a, touching));
  const Vec3 above[3] = {{0.25, 0.25, 1e-300}, {0.25, 0.25, 1}, {1, 1, 1}};
  EXPECT_FALSE(TrianglesIntersect(a, above));
}

TEST(CommonStretch, RunsFromSideToSide) {
  const Vec3 floor[3] = {{0, 0, 0}, {4, 0, 0}, {0, 4, 0}};
  const Vec3 blade[3] = {{1, 1, -1}, {1, 1, 1}, {1, -3, 1}};  // through the floor from y = 1 to its side at y = 0
  for (const auto& stretch : {CommonStretch(floor, blade), CommonStretch(blade, floor)}) {
    ASSERT_TRUE(stretch);
    const auto& [low, high] = (*stretch)[0].y < (*stretch)[1].y ? *stretch : std::array{(*stretch)[1], (*stretch)[0]};
    EXPECT_NEAR(Distance(low, {1, 0, 0}), 0, 1e-12);
    EXPECT_NEAR(Distance(high, {1, 1, 0}), 0, 1e-12);
  }
  const Vec3 beside[3] = {{5, 5, -1}, {5, 5, 1}, {6, 5, 1}}, in_plane[3] = {{1, 1, 0}, {2, 1, 0}, {1, 2, 0}};
  EXPECT_FALSE(CommonStretch(floor, beside));
  EXPECT_FALSE(CommonStretch(floor, in_plane));
}

TEST(SegmentMeetsTriangle, CrossesTouchesAndLiesInThePlane) {
  const Vec3 t[3] = {{0, 0, 0}, {4, 0, 0}, {0, 4, 0}};
  EXPECT_TRUE(SegmentMeetsTriangle({1, 1, -1}, {1, 1, 1}, t));
  EXPECT_FALSE(SegmentMeetsTriangle({1, 1, 0.5}, {1, 1, 1}, t));
  EXPECT_FALSE(SegmentMeetsTriangle({3, 3, -1}, {3, 3, 1}, t));
  EXPECT_TRUE(SegmentMeetsTriangle({2, 2, -1}, {2, 2, 1}, t));  // through a side
  EXPECT_TRUE(SegmentMeetsTriangle({-1, 1, 0}, {5, 1, 0}, t));  // in the plane
  EXPECT_FALSE(SegmentMeetsTriangle({5, 0, 0}, {0, 5, 0}, t));
  EXPECT_TRUE(SegmentMeetsTriangle({1, 1, 0}, {1.5, 1, 0}, t));  // inside
}

}  // namespace
}  // namespace meshfront
