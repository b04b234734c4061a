#include "core/front/settling_window.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numbers>

#include "core/front/advancing_front.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/core/front/fake_surfaces.h"
#include "tests/core/front/front_checks.h"
#include "tests/support/checking_sink.h"
#include "tests/support/matchers.h"

namespace meshfront {
namespace {

using meshfront::testing::CheckingSink;
using meshfront::testing::FaultOf;
using meshfront::testing::IsOk;
using meshfront::testing::LiveTriangles;
using meshfront::testing::PlaneSurface;
using meshfront::testing::SphereSurface;
using meshfront::testing::StatusIs;
using ::testing::IsEmpty;
using ::testing::SizeIs;

// A hexagon in the plane around a middle vertex, all of it behind the front.
struct Hexagon {
  explicit Hexagon(const Vec3& center, double radius = 1) {
    std::vector<WindowVertexId> v;
    for (int i = 0; i < 6; ++i) {  // clockwise: open inside
      const double angle = -std::numbers::pi / 3 * i;
      v.push_back(fronts.AddVertex({radius * Vec3{std::cos(angle), std::sin(angle), 0}, {0, 0, 1}}, radius, 0));
    }
    const FrontEdgeId first = fronts.AddLoop(v);
    middle = fronts.AddVertex({center, {0, 0, 1}}, radius, 0);
    FrontSet::Step step = fronts.Grow(first, middle);
    while (fronts.front_edge_count() >
           0) {  // around the middle: the next rim edge and the side that comes in from the middle
      const FrontEdgeId rim = fronts.at(step.made[step.made_count - 1]).next;
      step = fronts.Connect(rim, fronts.at(rim).prev, TriangleKind::kConnection);
    }
  }
  FrontSet fronts;
  WindowVertexId middle;
};

TEST(SettlingWindow, MovesAVertexToTheMiddleOfItsRing) {
  const PlaneSurface plane;
  Hexagon hexagon({0.6, 0.2, 0});
  ASSERT_EQ(FaultOf(hexagon.fronts), "");
  CheckingSink sink;
  SettlingWindow window(plane, hexagon.fronts, {}, sink);
  EXPECT_THAT(window.Improve({}), IsEmpty());
  EXPECT_LT(Norm(hexagon.fronts.at(hexagon.middle).position), 0.3);
  for (uint32_t i = 0; i < 6; ++i) {
    EXPECT_NEAR(Norm(hexagon.fronts.at(WindowVertexId(i)).position), 1, 1e-15) << "a rim vertex moved";
  }
}

TEST(SettlingWindow, LeavesEverythingAsItIsWhenAllIsOff) {
  const PlaneSurface plane;
  const Vec3 place{0.6, 0.2, 0};
  Hexagon hexagon(place);
  CheckingSink sink;
  SettlingWindow window(plane, hexagon.fronts, {.flips = false, .smooth = false, .fit = false}, sink);
  EXPECT_THAT(window.Improve({}), IsEmpty());
  EXPECT_EQ(hexagon.fronts.at(hexagon.middle).position, place);
  EXPECT_EQ(window.counts().flips, 0u);
}

TEST(SettlingWindow, DoesNotMoveWhatWasSent) {
  const PlaneSurface plane;
  const Vec3 place{0.6, 0.2, 0};
  Hexagon hexagon(place);
  hexagon.fronts.at(hexagon.middle).emitted = VertexId(0);
  CheckingSink sink;
  SettlingWindow window(plane, hexagon.fronts, {}, sink);
  window.Improve({});
  EXPECT_EQ(hexagon.fronts.at(hexagon.middle).position, place);
}

TEST(SettlingWindow, DoesNotTouchWhatLiesNextToAFront) {
  const PlaneSurface plane;
  const Vec3 place{0.6, 0.2, 0};
  Hexagon hexagon(place);
  hexagon.fronts.Remove({{LiveTriangles(hexagon.fronts)[0]}});
  CheckingSink sink;
  SettlingWindow window(plane, hexagon.fronts, {}, sink);
  window.Improve({});
  EXPECT_EQ(hexagon.fronts.at(hexagon.middle).position, place);
  ASSERT_THAT(window.Emit(false), IsOk());
  EXPECT_EQ(sink.pieces, 0) << "nothing is far enough from the front";
}

TEST(SettlingWindow, HoldsBackWhatLiesNextToAFrontThatHasRetreated) {
  const PlaneSurface plane;
  Hexagon hexagon({0, 0, 0});
  CheckingSink sink;
  SettlingWindow window(plane, hexagon.fronts, {}, sink);
  window.Improve({});
  hexagon.fronts.Remove({{LiveTriangles(hexagon.fronts)[0]}});
  window.MeasureDepth();
  ASSERT_THAT(window.Emit(false), IsOk());
  EXPECT_EQ(sink.pieces, 0);
}

TEST(SettlingWindow, SendsEverythingAtTheEnd) {
  const PlaneSurface plane;
  Hexagon hexagon({0, 0, 0});
  CheckingSink sink;
  SettlingWindow window(plane, hexagon.fronts, {}, sink);
  window.Improve({});
  ASSERT_THAT(window.Emit(true), IsOk());
  sink.CheckEnd();
  EXPECT_THAT(sink.complaints(), IsEmpty());
  EXPECT_THAT(sink.mesh().positions, SizeIs(7));
  EXPECT_THAT(sink.mesh().triangles, SizeIs(6));
  EXPECT_EQ(window.counts().triangles, 6u);
  EXPECT_EQ(window.counts().vertices, 7u);
  EXPECT_EQ(window.counts().by_kind[0], 1u);
  EXPECT_EQ(window.counts().by_kind[1], 5u);
  EXPECT_NEAR(window.counts().longest_edge, 1, 1e-6);
  EXPECT_EQ(hexagon.fronts.triangle_count(), 0u);
}

// A kite whose long diagonal was made; the short one gives two rounder triangles.
TEST(SettlingWindow, TurnsAnEdgeThatRaisesTheSmallestAngle) {
  const PlaneSurface plane;
  for (const bool flips : {true, false}) {
    FrontSet fronts;
    std::vector<WindowVertexId> v;
    for (const Vec3& p : {Vec3{-1, 0, 0}, Vec3{0, 0.4, 0}, Vec3{1, 0, 0}, Vec3{0, -0.4, 0}})
      v.push_back(fronts.AddVertex({p, {0, 0, 1}}, 1, 0));
    const FrontEdgeId e = fronts.AddLoop(v);  // clockwise
    const FrontSet::Step step =
        fronts.Connect(e, fronts.at(fronts.at(e).next).next, TriangleKind::kConnection);  // −1 … 1
    fronts.Connect(step.made[0], fronts.at(step.made[0]).prev, TriangleKind::kClosing);
    ASSERT_EQ(FaultOf(fronts), "");
    ASSERT_TRUE(fronts.EdgeExists(v[0], v[2]));
    CheckingSink sink;
    SettlingWindow window(plane, fronts, {.flips = flips}, sink);
    window.Improve({});
    EXPECT_EQ(FaultOf(fronts), "");
    EXPECT_EQ(window.counts().flips, flips ? 1u : 0u) << "once, not to and fro";
    EXPECT_EQ(fronts.EdgeExists(v[1], v[3]), flips);
    EXPECT_EQ(fronts.EdgeExists(v[0], v[2]), !flips);
  }
}

// A flat rhombus with a vertex in its middle: four slivers of 0.22; without the vertex two triangles of 0.42.
TEST(SettlingWindow, RemovesAVertexWhoseRingIsRounderWithoutIt) {
  const PlaneSurface plane;
  for (const bool smooth : {true, false}) {
    FrontSet fronts;
    std::vector<WindowVertexId> v;
    for (const Vec3& p : {Vec3{-0.5, 0, 0}, Vec3{0, 0.06, 0}, Vec3{0.5, 0, 0}, Vec3{0, -0.06, 0}})
      v.push_back(fronts.AddVertex({p, {0, 0, 1}}, 1, 0));
    FrontEdgeId e = fronts.AddLoop(v);  // clockwise
    const WindowVertexId middle = fronts.AddVertex({{0, 0, 0}, {0, 0, 1}}, 1, 0);
    e = fronts.at(fronts.Grow(e, middle).made[1]).next;
    for (int i = 0; i < 2; ++i)
      e = fronts.at(fronts.Connect(e, fronts.at(e).prev, TriangleKind::kConnection).made[0]).next;
    fronts.Connect(e, fronts.at(e).prev, TriangleKind::kClosing);
    ASSERT_EQ(FaultOf(fronts), "");
    ASSERT_EQ(fronts.triangle_count(), 4u);
    CheckingSink sink;
    SettlingWindow window(plane, fronts, {.smooth = smooth}, sink);
    EXPECT_THAT(window.Improve({}), IsEmpty());
    EXPECT_EQ(FaultOf(fronts), "");
    EXPECT_EQ(fronts.at(middle).alive, !smooth);
    EXPECT_EQ(fronts.triangle_count(), smooth ? 2u : 4u);
    EXPECT_EQ(fronts.EdgeExists(v[1], v[3]), smooth);
  }
}

// The same rhombus with one more triangle at its upper right side, whose tip f alone has not been looked at before. Of the triangles
// around the middle two have no corner next to f: they are not among those that the sweeps know.
//
//              f
//       _ b _ / |
//     a - m - - c
//       - d -
TEST(SettlingWindow, RemovesAVertexOnlyWithItsWholeStar) {
  const PlaneSurface plane;
  FrontSet fronts;
  std::vector<WindowVertexId> v;
  for (const Vec3& p : {Vec3{-0.5, 0, 0}, Vec3{0, 0.06, 0}, Vec3{0.4, 0.4, 0}, Vec3{0.5, 0, 0}, Vec3{0, -0.06, 0}})
    v.push_back(fronts.AddVertex({p, {0, 0, 1}}, 1, 0));
  const FrontEdgeId first = fronts.AddLoop(v);  // clockwise
  const FrontEdgeId beside = fronts.at(first).next;
  fronts.Connect(beside, fronts.at(fronts.at(beside).next).next, TriangleKind::kConnection);  // b f c
  const WindowVertexId middle = fronts.AddVertex({{0, 0, 0}, {0, 0, 1}}, 1, 0);
  FrontEdgeId e = fronts.at(fronts.Grow(first, middle).made[1]).next;
  for (int i = 0; i < 2; ++i)
    e = fronts.at(fronts.Connect(e, fronts.at(e).prev, TriangleKind::kConnection).made[0]).next;
  fronts.Connect(e, fronts.at(e).prev, TriangleKind::kClosing);
  ASSERT_EQ(FaultOf(fronts), "");
  ASSERT_EQ(fronts.triangle_count(), 5u);
  CheckingSink sink;
  SettlingWindow window(plane, fronts, {.flips = false, .fit = false}, sink);
  for (const bool all_are_new : {false, true}) {
    for (const WindowVertexId u : v) fronts.at(u).improved = !all_are_new;
    fronts.at(middle).improved = !all_are_new;
    fronts.at(v[2]).improved = false;
    window.Improve({});
    EXPECT_EQ(FaultOf(fronts), "");
    EXPECT_EQ(fronts.at(middle).alive, !all_are_new);
  }
}

// Two triangles that pierce each other, as two fronts on one sheet would make them.
struct Pierced {
  Pierced() {
    AddTriangle({{-1, 0, 0}, {0, 2, 0}, {1, 0, 0}}, {0, 0, 1});
    AddTriangle({{0, 0.5, -1}, {0, 0.5, 1}, {0, 3, 0}}, {1, 0, 0});
  }
  void AddTriangle(const std::vector<Vec3>& places, const Vec3& normal) {
    std::vector<WindowVertexId> v;
    for (const Vec3& p : places) v.push_back(fronts.AddVertex({p, normal}, 1, 0));
    const FrontEdgeId e = fronts.AddLoop(v);
    fronts.Connect(e, fronts.at(e).prev, TriangleKind::kClosing);
  }
  FrontSet fronts;
};

TEST(SettlingWindow, SendsIntersectingTrianglesBack) {
  const PlaneSurface plane;
  Pierced pierced;
  CheckingSink sink;
  SettlingWindow window(plane, pierced.fronts, {.flips = false, .smooth = false, .fit = false}, sink);
  EXPECT_THAT(window.Improve({}), SizeIs(2));
  EXPECT_THAT(window.faults(), IsEmpty());
}

TEST(SettlingWindow, ReportsThePlaceOfAnIntersectionThatWasGivenUp) {
  const PlaneSurface plane;
  Pierced pierced;
  CheckingSink sink;
  SettlingWindow window(plane, pierced.fronts, {.flips = false, .smooth = false, .fit = false}, sink);
  window.GiveUp(window.Improve({})[0].triangle);
  EXPECT_THAT(window.Improve({}), IsEmpty());
  ASSERT_THAT(window.Emit(true), IsOk());
  EXPECT_THAT(window.faults(), SizeIs(1));
}

TEST(SettlingWindow, StopsImprovingWhenTheJobIsCancelled) {
  const PlaneSurface plane;
  Hexagon hexagon({0.6, 0.2, 0});
  CheckingSink sink;
  const std::atomic<bool> stop = true;
  Context context;
  context.stop = &stop;
  SettlingWindow window(plane, hexagon.fronts, {}, sink);
  window.Improve(context);
  EXPECT_EQ(hexagon.fronts.at(hexagon.middle).position, (Vec3{0.6, 0.2, 0}));
}

TEST(SettlingWindow, PassesTheSinksStatusOn) {
  class Full : public MeshSink {
    absl::Status Append(const MeshPiece&) override { return absl::ResourceExhaustedError("full"); }
  };
  const PlaneSurface plane;
  Hexagon hexagon({0, 0, 0});
  Full sink;
  SettlingWindow window(plane, hexagon.fronts, {}, sink);
  window.Improve({});
  EXPECT_THAT(window.Emit(true), StatusIs(absl::StatusCode::kResourceExhausted, "full"));
}

FrontReport SphereWith(const FrontOptions& options, CheckingSink& sink) {
  const SphereSurface sphere;
  const GuidanceField field = *GuidanceField::Create({{{0, 0, 1}, 0.05}}, {1.2, 0, 0.15}, {});
  return *AdvanceFront(sphere, field, {}, {sphere.Project({1, 0, 0}, 0)}, options, sink, {});
}

TEST(SettlingWindow, ImprovesTheWorstTriangles) {
  CheckingSink plain_sink, flips_sink, both_sink;
  const QualityReport plain = SphereWith({.flips = false, .smooth = false, .fit = false}, plain_sink).quality;
  const QualityReport flips = SphereWith({.flips = true, .smooth = false, .fit = false}, flips_sink).quality;
  const QualityReport both = SphereWith({.flips = true, .smooth = true, .fit = false}, both_sink).quality;
  EXPECT_GE(flips.min_angle_deg, plain.min_angle_deg);
  EXPECT_GT(both.min_angle_deg, plain.min_angle_deg);
  EXPECT_GT(both.radius_ratio_p0_5, plain.radius_ratio_p0_5);
}

TEST(SettlingWindow, KeepsEveryVertexOnTheSurfaceWithoutTheFit) {
  CheckingSink on, off;
  SphereWith({}, on);
  SphereWith({.fit = false}, off);
  double worst_on = 0, worst_off = 0;
  for (const Vec3& p : off.mesh().positions) worst_off = std::max(worst_off, std::abs(Norm(p) - 1));
  for (const Vec3& p : on.mesh().positions) worst_on = std::max(worst_on, std::abs(Norm(p) - 1));
  EXPECT_LT(worst_off, 1e-9);
  EXPECT_GT(worst_on, 1e-5) << "the fit did nothing";
}

// Mean squared distance of edge middles and centroids from the sphere.
double MeanSquaredError(const TriangleMesh& mesh) {
  double sum = 0;
  for (const Triangle& t : mesh.triangles) {
    const Vec3 a = mesh.PositionAt(t[0]), b = mesh.PositionAt(t[1]), c = mesh.PositionAt(t[2]);
    for (const Vec3& p : {0.5 * (a + b), 0.5 * (b + c), 0.5 * (c + a), (a + b + c) / 3.0})
      sum += std::pow(Norm(p) - 1, 2);
  }
  return sum / (4.0 * static_cast<double>(mesh.triangles.size()));
}

TEST(SettlingWindow, FitsTheSurfaceBetweenTheVertices) {
  CheckingSink on, off;
  SphereWith({}, on);
  SphereWith({.fit = false}, off);
  EXPECT_LT(MeanSquaredError(on.mesh()), 0.5 * MeanSquaredError(off.mesh()));
}

}  // namespace
}  // namespace meshfront
