#include "core/features/curve.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "core/geometry/segment.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace meshfront {
namespace {

using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

// A circle around the origin; every second vertex moved outward by `zigzag`.
Curve Circle(int n, double radius = 1, double zigzag = 0) {
  std::vector<Vec3> points;
  for (int i = 0; i < n; ++i) {
    const double angle = 2 * std::numbers::pi * i / n, r = radius + (i % 2) * zigzag;
    points.push_back({r * std::cos(angle), r * std::sin(angle), 0});
  }
  return Curve(points);
}

// The square [0, side]², n edges a side, counter-clockwise from the origin: corners at 0, n, 2n, 3n.
Curve Square(int n, double side = 1) {
  const Vec3 corners[4] = {{0, 0, 0}, {side, 0, 0}, {side, side, 0}, {0, side, 0}};
  std::vector<Vec3> points;
  for (int c = 0; c < 4; ++c) {
    for (int i = 0; i < n; ++i) points.push_back(Lerp(corners[c], corners[(c + 1) % 4], static_cast<double>(i) / n));
  }
  return Curve(points);
}

std::vector<CurvePoint> Resample(const Curve& curve, LengthField field) {
  auto points = ResampleCurve(curve, field, {});
  EXPECT_TRUE(points.ok()) << points.status();
  return *std::move(points);
}

std::vector<double> ChordsOf(const Curve& curve, const std::vector<CurvePoint>& points) {
  std::vector<double> chords;
  for (size_t i = 0; i < points.size(); ++i) {
    chords.push_back(Distance(curve.At(points[i]), curve.At(points[(i + 1) % points.size()])));
  }
  return chords;
}

// In the order of the curve, once around, no two the same.
bool RunsOnceAround(const Curve& curve, const std::vector<CurvePoint>& points) {
  double covered = 0;
  for (size_t i = 0; i < points.size(); ++i) {
    double step = curve.ArcAt(points[(i + 1) % points.size()]) - curve.ArcAt(points[i]);
    if (step <= 0) step += curve.length();
    covered += step;
  }
  return std::abs(covered - curve.length()) < 1e-9 * curve.length();
}

TEST(Curve, FindsThePlaceAtAnArcLengthAndBack) {
  const Curve square = Square(4);
  EXPECT_EQ(square.length(), 4);
  EXPECT_EQ(square.At(square.PointAtArc(1.125)), (Vec3{1, 0.125, 0}));
  EXPECT_EQ(square.PointAtArc(4.5).segment, 18);  // once around, and two edges
  for (double arc : {0.0, 0.3, 3.99, 4.0, 5.6, 7.9}) EXPECT_NEAR(square.ArcAt(square.PointAtArc(arc)), arc, 1e-12);
}

TEST(CurveCorners, AreTheFourOfASquare) {
  for (double g : {0.01, 0.1, 0.4}) {
    EXPECT_THAT(*FindCorners(Square(25), [=](const Vec3&) { return g; }, {}), ElementsAre(0, 25, 50, 75)) << g;
  }
}

TEST(CurveCorners, AreNotFoundOnACircleOrAZigzag) {
  EXPECT_THAT(*FindCorners(Circle(100), [](const Vec3&) { return 0.2; }, {}), IsEmpty());
  // Edges of about 0.06 that turn by 77° at every vertex.
  EXPECT_THAT(*FindCorners(Circle(100, 1, 0.05), [](const Vec3&) { return 0.3; }, {}), IsEmpty());
}

TEST(CurveResampling, SpacesACircleEvenly) {
  const Curve circle = Circle(1000);
  const auto points = Resample(circle, [](const Vec3&) { return 0.1; });
  EXPECT_NEAR(points.size(), 63, 1);
  for (double chord : ChordsOf(circle, points)) EXPECT_NEAR(chord, 0.1, 0.001);
  EXPECT_TRUE(RunsOnceAround(circle, points));
}

TEST(CurveResampling, FollowsAGradedField) {
  // From 0.02 at (1, 0) to 0.02 + 2/6 at (−1, 0).
  const Curve circle = Circle(1000);
  auto field = [](const Vec3& x) { return 0.02 + Distance(x, {1, 0, 0}) / 6; };
  const auto points = Resample(circle, field);
  const auto chords = ChordsOf(circle, points);
  for (size_t i = 0; i < points.size(); ++i) {
    const double g = field(circle.At(points[i]));
    EXPECT_GT(chords[i], g / 1.2);
    EXPECT_LT(chords[i], g * 1.2);
  }
}

TEST(CurveResampling, TakesChordsNotArcsOnAZigzag) {
  // The arc is 1.8 times as long as the way around.
  const Curve circle = Circle(400, 1, 0.025);
  const auto chords = ChordsOf(circle, Resample(circle, [](const Vec3&) { return 0.2; }));
  EXPECT_THAT(chords, Each(::testing::AllOf(::testing::Gt(0.15), ::testing::Lt(0.26))));
}

TEST(CurveResampling, KeepsCornersExactlyAndDividesSidesEvenly) {
  const Curve square = Square(7);
  const auto points = Resample(square, [](const Vec3&) { return 0.21; });
  ASSERT_EQ(points.size(), 20);
  for (uint32_t corner : {0, 7, 14, 21}) EXPECT_THAT(points, ::testing::Contains(CurvePoint{corner, 0}));
  EXPECT_THAT(ChordsOf(square, points), Each(::testing::DoubleNear(0.2, 1e-12)));
}

TEST(CurveResampling, GivesThreeSpanningVerticesOfATinyCurve) {
  for (const Curve& curve : {Circle(3), Circle(4), Circle(50), Square(10)}) {
    const auto points = Resample(curve, [](const Vec3&) { return 1e3; });
    ASSERT_GE(points.size(), 3);
    EXPECT_TRUE(RunsOnceAround(curve, points));
    for (const CurvePoint& p : points) EXPECT_EQ(p.t, 0);
    EXPECT_GT(Norm(Cross(curve.At(points[1]) - curve.At(points[0]), curve.At(points[2]) - curve.At(points[0]))), 0.4);
  }
}

TEST(CurveResampling, FollowsHairpinsThatTheFieldWouldStepAcross) {
  // A comb of hairpins 1 high and 0.2 wide, in a field of 0.5 that would step across them.
  std::vector<Vec3> points;
  for (int i = 0; i < 10; ++i) {
    for (int k = 0; k <= 20; ++k) points.push_back({0.2 * i, (i % 2 ? 20 - k : k) / 20.0, 0});
  }
  points.push_back({1.8, -1, 0});
  points.push_back({0, -1, 0});
  const Curve comb(points);
  const auto resampled = Resample(comb, [](const Vec3&) { return 0.5; });
  EXPECT_TRUE(RunsOnceAround(comb, resampled));
  double farthest = 0;
  for (const Vec3& p : points) {
    double nearest = 1e9;
    for (size_t i = 0; i < resampled.size(); ++i) {
      const Vec3 a = comb.At(resampled[i]), b = comb.At(resampled[(i + 1) % resampled.size()]);
      const double t = std::clamp(Dot(p - a, b - a) / SquaredNorm(b - a), 0.0, 1.0);
      nearest = std::min(nearest, Distance(p, Lerp(a, b, t)));
    }
    farthest = std::max(farthest, nearest);
  }
  EXPECT_LT(farthest, 0.3);  // 0.6 g, the least distance between such vertices; 1 without them
}

TEST(CurveResampling, EndsOnCurvesWithRepeatedPlaces) {
  // A figure of eight whose middle is two vertices at one place, a curve of zero length, and one there and back.
  const std::vector<std::vector<Vec3>> curves{{{0, 0, 0}, {1, 1, 0}, {1, -1, 0}, {0, 0, 0}, {-1, 1, 0}, {-1, -1, 0}},
                                              {{1, 1, 1}, {1, 1, 1}, {1, 1, 1}, {1, 1, 1}},
                                              {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {1, 0, 0}}};
  for (const auto& vertices : curves) {
    for (double g : {0.1, 1.0, 100.0}) {
      const Curve curve(vertices);
      EXPECT_GE(Resample(curve, [=](const Vec3&) { return g; }).size(), 3);
    }
  }
}

TEST(CurveResampling, KeepsRandomCurvesInOrderAndDistinct) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (int run = 0; run < 300; ++run) {
    std::vector<Vec3> vertices;
    for (int i = 0; i < 3 + run % 40; ++i) {
      const double x = unit(random), y = unit(random), z = unit(random);
      vertices.push_back({x, y, z});
    }
    const Curve curve(vertices);
    const double g = std::pow(10, -2 + 0.01 * run);
    const auto points = Resample(curve, [=](const Vec3& x) { return g * (1 + 0.1 * x.x); });
    ASSERT_GE(points.size(), 3);
    ASSERT_TRUE(RunsOnceAround(curve, points)) << run;
    ASSERT_THAT(ChordsOf(curve, points), Each(::testing::Gt(0)));
  }
}

// Three sides of the unit square, n edges a side, from (0, 1) down to the origin and around to (1, 1).
Curve Cup(int n) {
  const Vec3 corners[4] = {{0, 1, 0}, {0, 0, 0}, {1, 0, 0}, {1, 1, 0}};
  std::vector<Vec3> points;
  for (int c = 0; c < 3; ++c) {
    for (int i = 0; i < n; ++i) points.push_back(Lerp(corners[c], corners[c + 1], static_cast<double>(i) / n));
  }
  points.push_back(corners[3]);
  return Curve(points, false);
}

std::vector<CurvePoint> ResampleWith(const Curve& curve, double g, size_t least = 1) {
  auto points = ResampleCurve(curve, [=](const Vec3&) { return g; }, {}, {.least = least});
  EXPECT_TRUE(points.ok()) << points.status();
  return *std::move(points);
}

TEST(OpenCurve, EndsAtItsLastVertex) {
  const Curve cup = Cup(5);
  EXPECT_FALSE(cup.closed());
  EXPECT_EQ(cup.length(), 3);
  EXPECT_LT(Distance(cup.At(cup.PointAtArc(1.5)), {0.5, 0, 0}), 1e-15);
  EXPECT_EQ(cup.At(cup.PointAtArc(3)), (Vec3{1, 1, 0}));
  for (double arc : {0.0, 0.3, 1.0, 2.99}) EXPECT_NEAR(cup.ArcAt(cup.PointAtArc(arc)), arc, 1e-12);
}

TEST(OpenCurve, HasCornersInsideOnly) {
  for (double g : {0.05, 0.2}) {
    EXPECT_THAT(*FindCorners(Cup(20), [=](const Vec3&) { return g; }, {}), ElementsAre(20, 40)) << g;
  }
}

TEST(OpenCurveResampling, StartsAtItsFirstEndAndLeavesTheLastOut) {
  const Curve cup = Cup(7);
  for (double g : {0.03, 0.21, 0.7}) {
    const auto points = ResampleWith(cup, g);
    ASSERT_FALSE(points.empty());
    EXPECT_EQ(points[0], (CurvePoint{0, 0}));
    EXPECT_LT(cup.ArcAt(points.back()), 3);
    EXPECT_GT(cup.ArcAt(points.back()), 3 - 1.5 * g) << "the last edge, to the end, is no longer than the others";
    for (size_t i = 1; i < points.size(); ++i) EXPECT_LT(cup.ArcAt(points[i - 1]), cup.ArcAt(points[i]));
  }
}

TEST(OpenCurveResampling, KeepsCornersExactlyAndDividesSidesEvenly) {
  const Curve cup = Cup(7);
  const auto points = ResampleWith(cup, 0.21);
  ASSERT_EQ(points.size(), 15u);
  for (uint32_t corner : {7, 14}) EXPECT_THAT(points, ::testing::Contains(CurvePoint{corner, 0}));
  for (size_t i = 0; i < 15; ++i) EXPECT_NEAR(cup.ArcAt(points[i]), 0.2 * static_cast<double>(i), 1e-12);
}

TEST(OpenCurveResampling, GivesOneEdgeToAShortCurveUnlessMoreAreAskedFor) {
  const Curve straight({{0, 0, 0}, {0.25, 0, 0}, {1, 0, 0}}, false);
  const Curve single({{0, 0, 0}, {1, 0, 0}}, false);
  for (const Curve& curve : {straight, single}) {
    EXPECT_THAT(ResampleWith(curve, 1e3), ElementsAre(CurvePoint{0, 0}));
    for (const size_t least : {2, 3}) {
      const auto points = ResampleWith(curve, 1e3, least);
      ASSERT_EQ(points.size(), least);
      for (size_t i = 0; i < least; ++i)
        EXPECT_NEAR(curve.At(points[i]).x, static_cast<double>(i) / static_cast<double>(least), 1e-12);
    }
    EXPECT_THAT(ResampleWith(curve, 0.1, 3), ::testing::SizeIs(10)) << "more than the least are left alone";
  }
}

TEST(CurveResampling, GivesAClosedCurveAsManyPointsAsAreAskedFor) {
  for (const size_t least : {1, 3, 4, 6}) {
    const auto points = ResampleWith(Circle(12), 1e3, least);
    EXPECT_EQ(points.size(), std::max(least, size_t{3}));
    EXPECT_TRUE(RunsOnceAround(Circle(12), points));
  }
}

TEST(OpenCurveResampling, FollowsABendThatTheFieldWouldStepAcross) {
  // An arc of 180° whose ends are 2 apart, in a field of 3.
  std::vector<Vec3> points;
  for (int i = 0; i <= 60; ++i) {
    const double angle = std::numbers::pi * i / 60;
    points.push_back({std::cos(angle), std::sin(angle), 0});
  }
  const Curve arc(points, false);
  const auto coarse = ResampleWith(arc, 1.5);
  EXPECT_GE(coarse.size(), 2u);
  double highest = 0;
  for (const CurvePoint& p : coarse) highest = std::max(highest, arc.At(p).y);
  EXPECT_GT(highest, 0.7);
}

// Half a circle and a whole one, whose field would take chords with a sagitta of 0.03: no vertex lies farther from its chord than asked for.
TEST(CurveResampling, KeepsTheSagittaThatIsAskedFor) {
  std::vector<Vec3> points;
  for (int i = 0; i < 180; ++i) {
    const double angle = std::numbers::pi * i / 90;
    points.push_back({std::cos(angle), std::sin(angle), 0});
  }
  const auto largest_sagitta = [](const Curve& curve, const CurveLimits& limits) {
    const auto found = ResampleCurve(
        curve, [](const Vec3&) { return 1.2; }, {}, limits);
    double largest = 0;
    for (size_t i = 0; found.ok() && i < found->size(); ++i) {
      const bool last = i + 1 == found->size();
      const Vec3 from = curve.At((*found)[i]),
                 to = last ? curve[curve.closed() ? 0 : curve.size() - 1] : curve.At((*found)[i + 1]);
      const size_t end = last ? curve.size() - 1 : (*found)[i + 1].segment;
      for (size_t k = (*found)[i].segment + 1; k <= end; ++k)
        largest = std::max(largest, DistanceToSegment(curve[k], from, to));
    }
    return found.ok() ? largest : 1;
  };
  for (const bool closed : {true, false}) {
    const Curve curve(closed ? points : std::vector<Vec3>(points.begin(), points.begin() + 91), closed);
    EXPECT_GT(largest_sagitta(curve, {}), 0.03);
    for (const double sagitta : {0.02, 0.01, 0.002}) {
      EXPECT_LE(largest_sagitta(curve, {.max_sagitta = sagitta}), sagitta);
      EXPECT_GT(largest_sagitta(curve, {.max_sagitta = sagitta, .shortest = 0.5}), 0.02) << "as short as edges may be";
    }
  }
}

TEST(OpenCurveResampling, ReadsTheSameForwardsAndBackwardsWhereTheFieldIsEven) {
  std::vector<Vec3> points{{0, 0, 0}, {0.3, 0.1, 0}, {0.8, 0.1, 0.2}, {1.7, 0, 0}};
  const Curve there(points, false);
  std::reverse(points.begin(), points.end());
  const Curve back(points, false);
  const auto a = ResampleWith(there, 0.25), b = ResampleWith(back, 0.25);
  ASSERT_EQ(a.size(), b.size());
}

TEST(CurveResampling, RefusesAFieldThatWouldFillTheMemory) {
  const auto points = ResampleCurve(Circle(10), [](const Vec3&) { return 1e-30; }, {});
  EXPECT_EQ(points.status().code(), absl::StatusCode::kResourceExhausted);
  EXPECT_THAT(points.status().message(), HasSubstr("boundary of length"));
}

TEST(CurveResampling, StopsWhenItsContextSaysSo) {
  const std::atomic<bool> stop = true;
  Context context;
  context.stop = &stop;
  EXPECT_FALSE(ResampleCurve(
                   Circle(10), [](const Vec3&) { return 0.1; }, context)
                   .ok());
}

TEST(CurveCurvature, IsTheInverseRadiusOfACircle) {
  for (int n : {16, 40, 1000}) {
    for (double curvature : CurveCurvatures(Circle(n, 0.25))) EXPECT_NEAR(curvature, 4, 0.25) << n;
  }
}

TEST(CurveCurvature, IsZeroOnASquareEvenAtItsCorners) {
  EXPECT_THAT(CurveCurvatures(Square(10)), Each(::testing::Lt(1e-9)));
}

TEST(CurveCurvature, IsBoundedByTheEdgesOnNoise) {
  // Every vertex a spike: at most 2 / edge.
  const Curve star = Circle(20, 1, 3);
  for (double curvature : CurveCurvatures(star)) EXPECT_LE(curvature, 2 / 3.0);
  // A zig-zag of a third of an edge reports its circle within a factor, not the zig-zag (whose turns have κ ≈ 20).
  for (double curvature : CurveCurvatures(Circle(100, 1, 0.02))) EXPECT_LT(curvature, 6);
}

std::vector<double> ChordsFor(const Curve& curve, double rho) {
  const std::vector<double> longest(curve.size(), curve.length() / 4);
  return *LongestChords(curve, longest, [=](double curvature) { return 2 * std::sin(rho / 2) / curvature; }, {});
}

TEST(CurveSagitta, TakesTheIdealChordOfACircle) {
  // Chords of 0.8 radians, within a step of 0.8 of the search; on 20,000 vertices as on 200.
  for (int n : {200, 20000}) {
    const auto chords = ChordsFor(Circle(n), 0.8);
    EXPECT_THAT(chords, Each(::testing::AllOf(::testing::Gt(0.75 * 0.78), ::testing::Le(0.8)))) << n;
  }
}

TEST(CurveSagitta, TakesTheLongestChordAlongStraightSides) {
  EXPECT_THAT(ChordsFor(Square(10), 0.8), Each(::testing::DoubleNear(1, 1e-9)));
  EXPECT_THAT(ChordsFor(Square(5000), 0.8), Each(::testing::DoubleNear(1, 1e-9)));
}

TEST(CurveSagitta, SeesBumpsNarrowerThanAnEdge) {
  // A circle whose radius waves by 0.05, 20 times around: chords of 0.8 would miss them. A chord from where the
  // wave is level to where it is again sees nothing, but one within each wave must.
  std::vector<Vec3> points;
  for (int i = 0; i < 400; ++i) {
    const double angle = 2 * std::numbers::pi * i / 400, r = 1 + 0.05 * std::sin(20 * angle);
    points.push_back({r * std::cos(angle), r * std::sin(angle), 0});
  }
  const auto chords = ChordsFor(Curve(points), 0.8);
  for (int i = 0; i < 400; i += 20) EXPECT_LT(*std::min_element(&chords[i], &chords[i] + 20), 0.1);
}

TEST(CurveSagitta, StopsWhenItsContextSaysSo) {
  const std::atomic<bool> stop = true;
  Context context;
  context.stop = &stop;
  const std::vector<double> longest(10, 1);
  EXPECT_FALSE(LongestChords(
                   Circle(10), longest, [](double) { return 1.0; }, context)
                   .ok());
}

}  // namespace
}  // namespace meshfront
