#include "core/front/fence_index.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <set>

#include "core/guidance/sizing.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace meshfront {
namespace {

constexpr Vec3 kUp{0, 0, 1};

Fence FenceOf(const Vec3& start, const Vec3& end, double half_height = 0.1, const Vec3& normal = kUp) {
  return {FrontEdgeId(), 0, 1, 0, start, end, normal, half_height};
}
NewEdge EdgeOf(const Vec3& start, const Vec3& end, double half_height = 0.1, const Vec3& normal = kUp) {
  return {start, end, normal, half_height};
}

// A front set of loops of three edges at random places, with lengths from 2^-20 to 2^10.
struct GradedEdges {
  explicit GradedEdges(uint64_t seed) : random(seed) {}
  double Uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random); }
  Vec3 Place(double size) { return {Uniform(-size, size), Uniform(-size, size), Uniform(-size, size)}; }
  std::vector<FrontEdgeId> AddLoop() {
    const double size = std::exp2(Uniform(-20, 10));
    const Vec3 middle = Place(std::exp2(Uniform(-10, 12)));
    std::vector<WindowVertexId> v;
    for (int i = 0; i < 3; ++i) v.push_back(fronts.AddVertex({middle + Place(size), kUp}, size, 0));
    const FrontEdgeId e = fronts.AddLoop(v);
    return {e, fronts.at(e).next, fronts.at(e).prev};
  }
  double DistanceTo(FrontEdgeId e, const Vec3& p) const {
    const Vec3 a = fronts.at(fronts.From(e)).position, d = fronts.at(fronts.To(e)).position - a;
    return Distance(p, a + std::clamp(Dot(p - a, d) / SquaredNorm(d), 0.0, 1.0) * d);
  }
  std::mt19937_64 random;
  FrontSet fronts;
};

// Edges come and go; whatever is within reach by looking at all of them is found, nothing that is gone, nothing twice.
TEST(FenceIndex, FindsWhatLookingAtEverythingFinds) {
  GradedEdges edges(1);
  FenceIndex index(edges.fronts);
  std::vector<FrontEdgeId> inside;
  size_t hits = 0;
  for (int round = 0; round < 600; ++round) {
    for (int i = 0; i < 3; ++i) {
      for (const FrontEdgeId e : edges.AddLoop()) index.Insert(e), inside.push_back(e);
    }
    for (int i = 0; i < 4 && !inside.empty(); ++i) {
      std::swap(inside[edges.random() % inside.size()], inside.back());
      index.Erase(inside.back());
      inside.pop_back();
    }
    const FrontEdgeId near = inside[edges.random() % inside.size()];
    const double radius = std::exp2(edges.Uniform(-20, 12));
    const Vec3 center = edges.fronts.at(edges.fronts.From(near)).position + edges.Place(radius);
    std::vector<FrontEdgeId> found;
    index.Query(center, radius, found);
    const std::set<FrontEdgeId> set(found.begin(), found.end());
    ASSERT_EQ(set.size(), found.size()) << "an edge was found twice";
    for (const FrontEdgeId e : found)
      ASSERT_EQ(std::count(inside.begin(), inside.end(), e), 1) << "an erased edge was found";
    for (const FrontEdgeId e : inside) {
      if (edges.DistanceTo(e, center) > radius) continue;
      ++hits;
      ASSERT_TRUE(set.count(e)) << "round " << round << ": an edge at " << edges.DistanceTo(e, center) << " within "
                                << radius;
    }
  }
  EXPECT_GT(hits, 5000u);
}

// Two indices of the same edges, one with its eye on a ball around some of them, before and after edges come and go.
TEST(FenceIndex, FindsTheSameInFocusAndOutOfItButForRounding) {
  GradedEdges edges(2);
  FenceIndex plain(edges.fronts), focused(edges.fronts);
  std::vector<FrontEdgeId> inside;
  size_t hits = 0;
  double focus_radius = 0;
  for (int round = 0; round < 400; ++round) {
    for (int i = 0; i < 3; ++i) {
      for (const FrontEdgeId e : edges.AddLoop()) plain.Insert(e), focused.Insert(e), inside.push_back(e);
    }
    for (int i = 0; i < 4; ++i) {
      std::swap(inside[edges.random() % inside.size()], inside.back());
      plain.Erase(inside.back()), focused.Erase(inside.back());
      inside.pop_back();
    }
    const Vec3 place = edges.fronts.at(edges.fronts.From(inside[edges.random() % inside.size()])).position;
    const double radius = std::exp2(edges.Uniform(-10, 12));
    if (round % 5 == 0) focused.Focus(place, focus_radius = 4 * radius, Normalized(edges.Place(1)));
    if (round % 50 == 49) focused.EndFocus();
    std::vector<FrontEdgeId> expected, got, nearly;
    plain.Query(place, radius, expected);
    focused.Query(place, radius, got);
    plain.Query(place, radius * (1 + 1e-4) + 1e-4 * focus_radius, nearly);
    for (std::vector<FrontEdgeId>* found : {&expected, &got, &nearly}) std::sort(found->begin(), found->end());
    ASSERT_TRUE(std::includes(got.begin(), got.end(), expected.begin(), expected.end())) << "round " << round;
    ASSERT_TRUE(std::includes(nearly.begin(), nearly.end(), got.begin(), got.end())) << "round " << round;
    hits += got.size();
  }
  EXPECT_GT(hits, 1000u);
}

TEST(FenceIndex, LooksAtLittleMoreThanWhatIsNear) {
  GradedEdges edges(2);
  FenceIndex index(edges.fronts);
  for (int i = 0; i < 60; ++i) {
    for (int j = 0; j < 60; ++j) {
      std::vector<WindowVertexId> v;
      for (const Vec3& p : {Vec3{0, 0, 0}, Vec3{1, 0, 0}, Vec3{0, 1, 0}}) {
        v.push_back(edges.fronts.AddVertex({p + Vec3{2.0 * i, 2.0 * j, 0}, kUp}, 1, 0));
      }
      FrontEdgeId e = edges.fronts.AddLoop(v);
      for (int k = 0; k < 3; ++k, e = edges.fronts.at(e).next) index.Insert(e);
    }
  }
  std::vector<FrontEdgeId> found;
  index.Query({60, 60, 0}, 2, found);
  EXPECT_GE(found.size(), 9u);
  EXPECT_LE(found.size(), 60u) << "of 10800";
}

TEST(FenceIndex, ErasesAnEdgeOnceAndTakesItBackIn) {
  GradedEdges edges(3);
  FenceIndex index(edges.fronts);
  const FrontEdgeId e = edges.AddLoop()[0];
  const Vec3 place = edges.fronts.at(edges.fronts.From(e)).position;
  std::vector<FrontEdgeId> found;
  index.Erase(e);  // never heard of
  index.Insert(e), index.Erase(e), index.Erase(e);
  index.Query(place, 1, found);
  EXPECT_THAT(found, ::testing::IsEmpty());
  index.Insert(e);
  index.Query(place, 1, found);
  EXPECT_THAT(found, ::testing::ElementsAre(e));
}

TEST(FenceIndex, TakesEdgesWithoutLengthAndFarAway) {
  FrontSet fronts;
  FenceIndex index(fronts);
  std::vector<WindowVertexId> v;
  for (const Vec3& p : {Vec3{1e300, 0, 0}, Vec3{1e300, 0, 0}, Vec3{0, 0, 0}})
    v.push_back(fronts.AddVertex({p, kUp}, 1, 0));
  FrontEdgeId e = fronts.AddLoop(v);
  for (int i = 0; i < 3; ++i, e = fronts.at(e).next) index.Insert(e);
  std::vector<FrontEdgeId> found;
  index.Query({1e300, 0, 0}, 1, found);
  EXPECT_EQ(found.size(), 3u);
  for (int i = 0; i < 3; ++i, e = fronts.at(e).next) index.Erase(e);
  found.clear();
  index.Query({1e300, 0, 0}, 1, found);
  EXPECT_THAT(found, ::testing::IsEmpty());
}

TEST(FenceIndex, KnowsAFencesGeometry) {
  FrontSet fronts;
  const WindowVertexId a = fronts.AddVertex({{0, 0, 0}, {0, 0, 1}}, 1, 0.5),
                       b = fronts.AddVertex({{2, 0, 0}, {1, 0, 0}}, 1, 0.25);
  const WindowVertexId c = fronts.AddVertex({{0, 2, 0}, kUp}, 1, 0);
  const FrontEdgeId e = fronts.AddLoop({{a, b, c}});
  FenceIndex index(fronts);
  index.Insert(e);
  const Fence& fence = index.at(e);
  EXPECT_EQ(fence.from, fronts.IdentityOf(a));
  EXPECT_EQ(fence.to, fronts.IdentityOf(b));
  EXPECT_NEAR(Distance(fence.normal, Normalized(Vec3{1, 0, 1})), 0, 1e-15);
  EXPECT_DOUBLE_EQ(fence.half_height, FenceHalfHeight(2, 0.5)) << "the greater curvature counts";
}

TEST(Fence, StandsAsHighAsTheErrorBoundAsks) {
  EXPECT_GT(FenceHalfHeight(1, 0), 0) << "noise on flat input";
  EXPECT_GE(FenceHalfHeight(1, 1), 2 * ErrorBound(1, 1));
  EXPECT_LT(FenceHalfHeight(0.5, 1), FenceHalfHeight(1, 1));
}

TEST(Fence, IsCrossedByAnEdgeThroughItsMiddle) {
  EXPECT_EQ(CrossFence(EdgeOf({0, -1, 0}, {0, 1, 0}), FenceOf({-1, 0, 0}, {1, 0, 0})), Crossing::kCrosses);
  EXPECT_EQ(CrossFence(EdgeOf({2, -1, 0}, {2, 1, 0}), FenceOf({-1, 0, 0}, {1, 0, 0})), Crossing::kNone) << "beside it";
  EXPECT_EQ(CrossFence(EdgeOf({0, 0.1, 0}, {0, 1, 0}), FenceOf({-1, 0, 0}, {1, 0, 0})), Crossing::kNone)
      << "ends before it";
}

TEST(Fence, CountsUpToTheGreaterOfTheTwoHeights) {
  const NewEdge low = EdgeOf({0, -1, 0.3}, {0, 1, 0.3}, 0.1), high = EdgeOf({0, -1, 0.3}, {0, 1, 0.3}, 0.31);
  EXPECT_EQ(CrossFence(low, FenceOf({-1, 0, 0}, {1, 0, 0}, 0.1)), Crossing::kUnclear)
      << "over it: another sheet, or rough";
  EXPECT_EQ(CrossFence(low, FenceOf({-1, 0, 0}, {1, 0, 0}, 0.31)), Crossing::kCrosses) << "the edge through the fence";
  EXPECT_EQ(CrossFence(high, FenceOf({-1, 0, 0}, {1, 0, 0}, 0.1)), Crossing::kCrosses)
      << "the front edge through the new edge's fence";
}

TEST(Fence, OnAnotherSheetIsLeftToTheSurface) {
  EXPECT_EQ(CrossFence(EdgeOf({0, -1, 0}, {0, 1, 0}), FenceOf({-1, 0, 0}, {1, 0, 0}, 0.1, -kUp)), Crossing::kUnclear);
  EXPECT_EQ(DistanceToFence({0, 0, 0}, kUp, FenceOf({-1, 0, 0}, {1, 0, 0}, 0.1, -kUp)),
            std::numeric_limits<double>::infinity());
  const Vec3 aside = Normalized(Vec3{1, 0, 0.2});
  EXPECT_EQ(CrossFence(EdgeOf({0, -1, 0}, {0, 1, 0}), FenceOf({-1, 0, 0}, {1, 0, 0}, 0.1, aside)), Crossing::kCrosses)
      << "around a sharp bend it is the same sheet";
  EXPECT_EQ(CrossFence(EdgeOf({2, -1, 0}, {2, 1, 0}), FenceOf({-1, 0, 0}, {1, 0, 0}, 0.1, aside)), Crossing::kUnclear)
      << "but what lies beside it there depends on where one stands";
}

TEST(Fence, IsCrossedWhicheverOfTheTwoIsTheNewEdge) {
  std::mt19937_64 random(4);
  std::uniform_real_distribution<double> unit(-1, 1);
  const auto place = [&] { return Vec3{unit(random), unit(random), 0.2 * unit(random)}; };
  int crossings = 0;
  for (int i = 0; i < 20000; ++i) {
    const Vec3 a = place(), b = place(), c = place(), d = place();
    const Vec3 m = Normalized(place() + 3 * kUp), n = Normalized(place() + 3 * kUp);
    const double h = 0.2 * std::abs(unit(random)), k = 0.2 * std::abs(unit(random));
    const Crossing one = CrossFence(EdgeOf(a, b, h, m), FenceOf(c, d, k, n));
    ASSERT_EQ(one, CrossFence(EdgeOf(c, d, k, n), FenceOf(a, b, h, m))) << i;
    ASSERT_EQ(one, CrossFence(EdgeOf(b, a, h, m), FenceOf(d, c, k, n))) << i << ", turned round";
    crossings += one == Crossing::kCrosses;
  }
  EXPECT_GT(crossings, 1000);
}

TEST(Fence, IsAsFarAsItsNearestPoint) {
  const Fence fence = FenceOf({-1, 0, 0}, {1, 0, 0});
  EXPECT_DOUBLE_EQ(DistanceToFence({0.3, 2, 0}, kUp, fence), 2);
  EXPECT_DOUBLE_EQ(DistanceToFence({4, 4, 0}, kUp, fence), 5) << "to its end";
  EXPECT_DOUBLE_EQ(DistanceToFence({-1, 0, 0.5}, kUp, fence), 0.5);
}

Vec3 Direction(double degrees) {
  const double radians = degrees * std::numbers::pi / 180;
  return {std::cos(radians), std::sin(radians), 0};
}

TEST(ClockwiseTurn, IsExactAtMultiplesOf45Degrees) {
  constexpr double kHalf = 0.5;
  const Vec3 directions[8] = {{1, 0, 0},  {kHalf, -kHalf, 0}, {0, -1, 0}, {-kHalf, -kHalf, 0},
                              {-1, 0, 0}, {-kHalf, kHalf, 0}, {0, 1, 0},  {kHalf, kHalf, 0}};
  for (int from = 0; from < 8; ++from) {
    for (int turn = 0; turn < 8; ++turn) {
      EXPECT_EQ(ClockwiseTurn(kUp, directions[from], directions[(from + turn) % 8]), 0.5 * turn)
          << from << ", " << turn;
    }
  }
}

TEST(ClockwiseTurn, GrowsWithTheAngle) {
  for (const double start : {0.0, 17.0, 133.0, 270.0}) {
    double last = -1;
    for (double angle = 0; angle < 360; angle += 0.125) {
      const double turn = ClockwiseTurn(kUp, Direction(start), Direction(start - angle));
      EXPECT_GE(turn, 0);
      EXPECT_LT(turn, 4);
      ASSERT_GT(turn, last) << start << ", " << angle;
      last = turn;
    }
  }
}

TEST(ClockwiseTurn, LooksAlongTheNormalWhateverItsLengthAndTheirs) {
  const Vec3 lifted = Direction(-90) + 5 * kUp;
  EXPECT_NEAR(ClockwiseTurn(kUp, Direction(0), lifted), 1, 1e-12);
  EXPECT_NEAR(ClockwiseTurn(kUp, 1e-8 * Direction(0), 1e8 * Direction(-90)), 1, 1e-12);
  EXPECT_NEAR(ClockwiseTurn(-kUp, Direction(0), Direction(90)), 1, 1e-12) << "from behind it turns the other way";
  EXPECT_EQ(ClockwiseTurn(kUp, {}, Direction(90)), 0) << "nothing has no direction";
}

TEST(ClockwiseTurn, StaysBelowAWholeTurn) {
  for (double tiny = 1e-5; tiny > 1e-300; tiny *= 1e-3) {
    EXPECT_LT(ClockwiseTurn(kUp, {1, 0, 0}, {1, tiny, 0}), 4.0) << tiny;
    EXPECT_GE(ClockwiseTurn(kUp, {1, 0, 0}, {1, tiny, 0}), 0.0) << tiny;
  }
}

}  // namespace
}  // namespace meshfront
