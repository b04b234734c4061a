#include "core/front/proposer.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <set>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/core/front/fake_surfaces.h"

namespace meshfront {
namespace {

using meshfront::testing::CylinderSurface;
using meshfront::testing::PlaneSurface;
using meshfront::testing::SheetsSurface;
using meshfront::testing::SphereSurface;

constexpr Vec3 kUp{0, 0, 1};
const Strictness& kStrict = kStrictness[0];

// Loops in a plane, drawn from above: the open side of a loop that runs clockwise is inside.
struct Scene {
  explicit Scene(std::unique_ptr<Surface> on = std::make_unique<PlaneSurface>()) : surface(std::move(on)) {}
  WindowVertexId Vertex(const Vec3& p, const Vec3& normal = kUp, double length = 1, uint32_t patch = 0) {
    return fronts.AddVertex({p, normal, patch}, length, 0);
  }
  // Edge i of the result starts at place i.
  std::vector<FrontEdgeId> Loop(const std::vector<WindowVertexId>& v) {
    std::vector<FrontEdgeId> edges = {fronts.AddLoop(v)};
    while (edges.size() < v.size()) edges.push_back(fronts.at(edges.back()).next);
    for (const FrontEdgeId e : edges) fences.Insert(e);
    return edges;
  }
  std::vector<FrontEdgeId> Loop(const std::vector<Vec3>& places, const Vec3& normal = kUp) {
    std::vector<WindowVertexId> v;
    for (const Vec3& p : places) v.push_back(Vertex(p, normal));
    return Loop(v);
  }
  Verdict Free(FrontEdgeId edge) { return proposer.ProposeFree(edge, free); }
  Verdict Check(FrontEdgeId edge, FrontEdgeId corner, const Strictness& strictness) {
    connection = {corner};
    return proposer.CheckConnection(edge, strictness, connection);
  }
  Verdict Propose(FrontEdgeId edge, const Strictness& strictness,
                  Proposer::Scrutiny scrutiny = Proposer::Scrutiny::kWhole) {
    return proposer.ProposeConnection(edge, strictness, scrutiny, connection);
  }

  std::unique_ptr<Surface> surface;
  FrontSet fronts;
  FenceIndex fences{fronts};
  Proposer proposer{*surface, fronts, fences};
  FreeProposal free;
  ConnectionProposal connection;
};

// A plane whose ways are what a map of it shows, however high their ends are drawn.
class MappedSurface : public PlaneSurface {
 public:
  bool HasWays() const override { return true; }
  bool TraceWay(const SourcePoint& a, const SourcePoint& b, std::vector<WayPiece>& way) const override {
    const auto on_map = [](const Vec3& p) { return Vec3{p.x, p.y, 0}; };
    way = {{0, on_map(a.position), on_map(b.position)}};
    return true;
  }
};

// A plane that counts how often it is asked for a place next to another.
class CountingSurface : public PlaneSurface {
 public:
  explicit CountingSurface(int* count) : count_(count) {}
  SourcePoint Snap(const SourcePoint& start, const Vec3& target) const override {
    ++*count_;
    return PlaneSurface::Snap(start, target);
  }

 private:
  int* count_;
};

// Edge 0 has length 1 and everything else is far away.
const std::vector<Vec3> kRoomy = {{0, 0, 0}, {1, 0, 0}, {9, -5, 0}, {1, -10, 0}, {0, -10, 0}, {-8, -5, 0}};

// Clockwise, sides of length 1; edge 0 runs from left to right along the top.
std::vector<Vec3> Polygon(int n) {
  std::vector<Vec3> places;
  const double radius = 0.5 / std::sin(std::numbers::pi / n);
  for (int i = 0; i < n; ++i) {
    const double angle = std::numbers::pi / 2 + std::numbers::pi / n * (1 - 2 * i);
    places.push_back(radius * Vec3{std::cos(angle), std::sin(angle), 0});
  }
  return places;
}

// --- Free triangles --------------------------------------------------------------------------------------------------------

TEST(ProposeFree, PlacesTheApexByTheLengthsAtBothEnds) {
  Scene scene;
  std::vector<WindowVertexId> v;
  for (size_t i = 0; i < kRoomy.size(); ++i) v.push_back(scene.Vertex(kRoomy[i], kUp, i == 0 ? 0.9 : 1.1));
  const FrontEdgeId e = scene.Loop(v)[0];
  ASSERT_EQ(scene.Free(e), Verdict::kAccepted);
  EXPECT_NEAR(Distance(scene.free.apex.position, {0, 0, 0}), 0.9, 1e-9);
  EXPECT_NEAR(Distance(scene.free.apex.position, {1, 0, 0}), 1.1, 1e-9);
  EXPECT_LT(scene.free.apex.position.y, 0) << "on the right of the edge";
}

TEST(ProposeFree, FindsNoApexBeyondTheRim) {
  Scene scene(std::make_unique<PlaneSurface>(0.9));
  EXPECT_EQ(scene.Free(scene.Loop(kRoomy)[0]), Verdict::kNoApex);
}

TEST(ProposeFree, RejectsATriangleAgainstTheSurfacesNormals) {
  Scene scene;
  std::vector<WindowVertexId> v = {scene.Vertex({0, 0, 0}, Normalized(Vec3{0, 0.98, 0.17}))};
  for (size_t i = 1; i < kRoomy.size(); ++i) v.push_back(scene.Vertex(kRoomy[i]));
  EXPECT_EQ(scene.Free(scene.Loop(v)[0]), Verdict::kNormalsDisagree);
}

TEST(ProposeFree, RejectsApexBehindTheNeighbouringEdge) {
  const double angle = -50 * std::numbers::pi / 180;  // less than the 60° that the triangle needs
  Scene before, after;
  EXPECT_EQ(
      before.Free(before.Loop({{0, 0, 0}, {1, 0, 0}, {9, -1, 0}, {5 * std::cos(angle), 5 * std::sin(angle), 0}})[0]),
      Verdict::kOutsideSector);
  EXPECT_EQ(
      after.Free(after.Loop({{0, 0, 0}, {1, 0, 0}, {1 - 5 * std::cos(angle), 5 * std::sin(angle), 0}, {-8, -1, 0}})[0]),
      Verdict::kOutsideSector);
}

TEST(ProposeFree, KeepsHalfAStepFromEveryFence) {
  for (const double gap : {0.45, 0.55}) {
    Scene scene;
    const FrontEdgeId e = scene.Loop(kRoomy)[0];
    const double y = -std::sqrt(0.75) - gap;  // counter-clockwise: meshed inside
    scene.Loop({{0.4, y, 0}, {0.5, y - 0.1, 0}, {0.6, y, 0}});
    EXPECT_EQ(scene.Free(e), gap < 0.5 ? Verdict::kTooClose : Verdict::kAccepted) << gap;
  }
}

TEST(ProposeFree, KeepsItsSidesAwayFromFrontVertices) {
  Scene scene;
  const FrontEdgeId e = scene.Loop(kRoomy)[0];
  scene.Loop({{-0.3, -0.2, 0}, {-0.35, -0.25, 0}, {-0.3, -0.3, 0}});
  EXPECT_EQ(scene.Free(e), Verdict::kTooClose);
}

TEST(ProposeFree, RejectsSidesThroughAFence) {
  Scene scene;
  const FrontEdgeId e = scene.Loop(kRoomy)[0];
  scene.Loop({{-3, -0.2, 0}, {3, -0.2, 0}, {0, 5, 0}});
  EXPECT_EQ(scene.Free(e), Verdict::kCrossesFence);
}

TEST(ProposeFree, IgnoresTheOtherSideOfAThinPlate) {
  Scene scene;
  const FrontEdgeId e = scene.Loop(kRoomy)[0];
  scene.Loop({{-3, -0.2, -0.01}, {3, -0.2, -0.01}, {0, 5, -0.01}}, -kUp);
  EXPECT_EQ(scene.Free(e), Verdict::kAccepted);
}

// Sheets between creases that come as close as rounding: what lies on another is not in the way.
TEST(ProposeFree, LooksAtItsOwnSheetAlone) {
  for (const uint32_t sheet : {0u, 1u}) {
    Scene scene;
    const FrontEdgeId e = scene.Loop(kRoomy)[0];
    std::vector<WindowVertexId> v;
    for (const Vec3& p : {Vec3{-3, -0.2, 0}, Vec3{3, -0.2, 0}, Vec3{0, 5, 0}}) {
      v.push_back(scene.Vertex(p));
      scene.fronts.at(v.back()).sheet = sheet;
    }
    scene.Loop(v);
    EXPECT_EQ(scene.Free(e), sheet == 0 ? Verdict::kCrossesFence : Verdict::kAccepted);
  }
}

// On rough ground a front edge may run far above a new one that crosses it.
TEST(ProposeFree, AsksTheSurfaceWhetherItCrossesWhatRunsAbove) {
  for (const Vec3& normal : {kUp, Normalized(Vec3{0, 1, -1})}) {
    Scene plain, mapped(std::make_unique<MappedSurface>());
    for (Scene* scene : {&plain, &mapped}) {
      const FrontEdgeId e = scene->Loop(kRoomy)[0];
      scene->Loop({{-3, -0.2, 1.5}, {3, -0.2, 1.5}, {0, 5, 1.5}}, normal);
      EXPECT_EQ(scene->Free(e), scene == &mapped ? Verdict::kCrossesFence : Verdict::kAccepted) << normal.z;
    }
  }
}

TEST(ProposeFree, KeepsTheRatioOfARoundTriangle) {
  Scene scene;
  const auto e = scene.Loop(kRoomy);
  EXPECT_NEAR(scene.proposer.FreeRatio(e[0]), 1, 1e-12);
  EXPECT_EQ(scene.proposer.FreeRatio(e[1]), 0) << "a base of 9.4 and two sides of 1";
}

// A base that is far too long or short is brought back in steps.
TEST(ProposeFree, LimitsTheSidesByTheBase) {
  for (const double length : {0.01, 100.0}) {
    Scene scene;
    std::vector<WindowVertexId> v;
    for (const Vec3& p : kRoomy) v.push_back(scene.Vertex(p, kUp, length));
    ASSERT_EQ(scene.Free(scene.Loop(v)[0]), Verdict::kAccepted) << length;
    EXPECT_NEAR(Distance(scene.free.apex.position, {0, 0, 0}), length < 1 ? 0.7 : 1.6, 1e-9);
  }
}

// --- Connections -----------------------------------------------------------------------------------------------------------

TEST(CheckConnection, AcceptsAnEarOfAPentagon) {
  Scene scene;
  const auto e = scene.Loop(Polygon(5));
  EXPECT_EQ(scene.Check(e[0], e[2], kStrict), Verdict::kAccepted);
  EXPECT_EQ(scene.Check(e[0], e[4], kStrict), Verdict::kAccepted);
  EXPECT_EQ(scene.Check(e[0], e[3], kStrict), Verdict::kAccepted) << "the corner across";
}

TEST(CheckConnection, TellsTheScoreOfToday) {
  Scene scene;
  const auto e = scene.Loop(Polygon(5));
  ASSERT_EQ(scene.Check(e[0], e[2], kStrict), Verdict::kAccepted);
  const double score = scene.connection.score;
  EXPECT_GT(score, 0) << "the smallest angle";
  ASSERT_EQ(scene.Check(e[0], e[3], kStrict), Verdict::kAccepted);
  EXPECT_NE(scene.connection.score, score);
}

// The front leads from corner to corner of an ear, so that one in the surface's plane stands for it; others may not.
TEST(CheckConnection, AsksTheSurfaceWhereACornerIsNoNeighbourOrItsNormalTurnsAway) {
  for (const double tilt : {0.0, 0.2, 0.6}) {  // of the normal at the ear's tip
    int asked = 0;
    Scene scene(std::make_unique<CountingSurface>(&asked));
    std::vector<WindowVertexId> v;
    for (const Vec3& p : Polygon(5)) v.push_back(scene.Vertex(p, v.size() == 2 ? Normalized(Vec3{tilt, 0, 1}) : kUp));
    const auto e = scene.Loop(v);
    ASSERT_EQ(scene.Check(e[0], e[2], kStrict), Verdict::kAccepted) << tilt;
    EXPECT_EQ(asked > 0, tilt > 0.5) << tilt;
    asked = 0;
    ASSERT_EQ(scene.Check(e[0], e[3], kStrict), Verdict::kAccepted) << tilt;
    EXPECT_GT(asked, 0) << "the corner across, " << tilt;
  }
}

TEST(CheckConnection, AcceptsTheLastTriangleOfALoop) {
  Scene scene;
  const auto e = scene.Loop(Polygon(3));
  EXPECT_EQ(scene.Check(e[0], e[2], kStrict), Verdict::kAccepted);
}

TEST(CheckConnection, RejectsSidesThatAreTooLong) {
  Scene scene;
  const auto e = scene.Loop(Polygon(7));
  EXPECT_EQ(scene.Check(e[0], e[2], kStrict), Verdict::kTooLong);
  EXPECT_EQ(scene.Check(e[0], e[2], kStrictness[1]), Verdict::kAccepted) << "until the tests are relaxed";
}

TEST(CheckConnection, RejectsATriangleAgainstTheSurfacesNormals) {
  Scene scene;
  const auto places = Polygon(5);
  std::vector<WindowVertexId> v;
  for (int i = 0; i < 5; ++i) v.push_back(scene.Vertex(places[i], i == 3 ? -kUp : kUp));
  const auto e = scene.Loop(v);
  EXPECT_EQ(scene.Check(e[0], e[3], kStrict), Verdict::kNormalsDisagree);
  EXPECT_EQ(scene.Check(e[0], e[3], kStrictness[3]), Verdict::kNormalsDisagree) << "at any strictness";
}

TEST(CheckConnection, RejectsATriangleWithoutArea) {
  Scene scene;
  const auto e = scene.Loop({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {1, -1, 0}});
  EXPECT_EQ(scene.Check(e[0], e[2], kStrictness[3]), Verdict::kNormalsDisagree);
}

// The side from the base's end to the far corner runs over the corner between: what is left there would have no area.
TEST(CheckConnection, LeavesNoCornerWithoutAnAngle) {
  for (const double off : {0.0, 1e-9, 0.2}) {
    Scene scene;
    const auto e = scene.Loop({{0, 0, 0}, {1, 0.5, 0}, {2, 0, 0}, {1, -off, 0}});  // clockwise: open inside
    EXPECT_EQ(scene.Check(e[0], e[2], kStrictness[3]), off < 0.1 ? Verdict::kOutsideSector : Verdict::kAccepted) << off;
  }
}

TEST(CheckConnection, RejectsApexBehindTheNeighbouringEdge) {
  Scene scene;
  const auto e = scene.Loop({{0, 0, 0}, {1, 0, 0}, {0.6, -0.5, 0}, {1, -1, 0}, {0, -1.5, 0}, {-0.5, -0.7, 0}});
  EXPECT_EQ(scene.Check(e[0], e[3], kStrict), Verdict::kOutsideSector);
}

TEST(CheckConnection, RejectsACornerThatOpensTheOtherWay) {
  // Below the edge another loop, meshed inside, offers its lowest corner, whose open side faces away.
  Scene scene;
  const FrontEdgeId e = scene.Loop(kRoomy)[0];
  const auto other = scene.Loop({{0.5, -1, 0}, {0.55, -0.95, 0}, {0.45, -0.95, 0}});
  EXPECT_EQ(scene.Check(e, other[0], kStrict), Verdict::kOutsideSector);
}

TEST(CheckConnection, RejectsAnEdgeThatExistsBehindTheFront) {
  Scene scene;
  const auto places = Polygon(5);
  WindowVertexId v0 = scene.Vertex(places[0]), x = scene.Vertex(places[1]), y = scene.Vertex(places[2]);
  WindowVertexId v1 = scene.Vertex(places[3]), v2 = scene.Vertex(places[4]);
  const auto edge_from = [&](WindowVertexId v) { return scene.fronts.at(v).first_corner; };
  scene.fronts.AddSeed(v0, v1, v2);  // three triangles fold back behind the pentagon v0 x y v1 v2
  scene.fronts.Grow(edge_from(v0), x);
  scene.fronts.Grow(edge_from(x), y);
  for (const WindowVertexId v : {v0, x, y, v1, v2}) scene.fences.Insert(edge_from(v));
  EXPECT_EQ(scene.Check(edge_from(y), edge_from(v0), kStrict), Verdict::kEdgeExists);
}

TEST(CheckConnection, RejectsTheBackOfATriangle) {
  Scene scene;
  const auto places = Polygon(3);
  FrontEdgeId e = scene.fronts.AddSeed(scene.Vertex(places[0]), scene.Vertex(places[1]), scene.Vertex(places[2]));
  for (int i = 0; i < 3; ++i, e = scene.fronts.at(e).next) scene.fences.Insert(e);
  EXPECT_EQ(scene.Check(e, scene.fronts.at(e).prev, kStrictness[3]), Verdict::kEdgeExists);
}

TEST(CheckConnection, RejectsTheEndsOfItsOwnEdge) {
  Scene scene;
  const auto e = scene.Loop(Polygon(5));
  EXPECT_EQ(scene.Check(e[0], e[0], kStrict), Verdict::kEdgeExists);
  EXPECT_EQ(scene.Check(e[0], e[1], kStrict), Verdict::kEdgeExists);
}

TEST(CheckConnection, RejectsATriangleAroundAFrontVertex) {
  Scene scene;
  const auto e = scene.Loop(Polygon(5));
  const Vec3 middle = (Polygon(5)[0] + Polygon(5)[1] + Polygon(5)[3]) / 3.0;
  scene.Loop({middle, middle + Vec3{0.01, -0.01, 0}, middle + Vec3{0.01, 0.01, 0}});
  EXPECT_EQ(scene.Check(e[0], e[3], kStrict), Verdict::kContainsVertex);
}

TEST(CheckConnection, KeepsItsSidesAwayFromFrontVertices) {
  Scene scene;
  const auto places = Polygon(5);
  const auto e = scene.Loop(places);
  const Vec3 beside = 0.5 * (places[0] + places[3]) + Vec3{-0.12, 0, 0};
  scene.Loop({beside, beside + Vec3{-0.02, -0.02, 0}, beside + Vec3{-0.02, 0.02, 0}});
  EXPECT_EQ(scene.Check(e[0], e[3], kStrict), Verdict::kTooClose);
  EXPECT_EQ(scene.Check(e[0], e[3], kStrictness[2]), Verdict::kAccepted) << "until the tests are relaxed";
}

TEST(CheckConnection, RejectsSidesThroughAFence) {
  Scene scene;
  const auto e = scene.Loop(Polygon(5));
  scene.Loop({{-2, 0, 0}, {2, 0, 0}, {0, 4, 0}});
  EXPECT_EQ(scene.Check(e[0], e[3], kStrict), Verdict::kCrossesFence);
  EXPECT_EQ(scene.Check(e[0], e[3], kStrictness[3]), Verdict::kCrossesFence) << "at any strictness";
}

TEST(CheckConnection, AsksTheSurfaceWhetherItCrossesWhatRunsAbove) {
  Scene plain, mapped(std::make_unique<MappedSurface>());
  for (Scene* scene : {&plain, &mapped}) {
    const auto e = scene->Loop(Polygon(5));
    scene->Loop({{-2, 0, 0.9}, {2, 0, 0.9}, {0, 4, 0.9}});
    EXPECT_EQ(scene->Check(e[0], e[3], kStrict), scene == &mapped ? Verdict::kCrossesFence : Verdict::kAccepted);
  }
}

// Rough ground on which no straight way leads anywhere.
class PathlessSurface : public PlaneSurface {
 public:
  bool HasWays() const override { return true; }
  bool TraceWay(const SourcePoint&, const SourcePoint&, std::vector<WayPiece>& way) const override {
    way.clear();
    return false;
  }
};

TEST(CheckConnection, CrossesWhatRunsAboveWhereNoWayTells) {
  for (const Vec3& normal : {kUp, -kUp}) {
    Scene scene(std::make_unique<PathlessSurface>());
    const auto e = scene.Loop(Polygon(5));
    scene.Loop({{-2, 0, 0.9}, {2, 0, 0.9}, {0, 4, 0.9}}, normal);
    EXPECT_EQ(scene.Check(e[0], e[3], kStrict), normal == kUp ? Verdict::kCrossesFence : Verdict::kAccepted)
        << "the other side of a plate is not in the way";
  }
}

// The front edge's slot is used again by another edge.
TEST(CheckConnection, ForgetsTheWaysOfFrontEdgesThatAreGone) {
  Scene scene(std::make_unique<MappedSurface>());
  const auto e = scene.Loop(Polygon(5));
  const auto above = scene.Loop({{-2, 0, 0.9}, {2, 0, 0.9}, {0, 4, 0.9}});
  EXPECT_EQ(scene.Check(e[0], e[3], kStrict), Verdict::kCrossesFence);
  for (const FrontEdgeId a : above) scene.fences.Erase(a);
  scene.fronts.Connect(above[0], above[2], TriangleKind::kClosing);
  std::vector<WindowVertexId> aside;
  for (const Vec3& p : {Vec3{-2, 3, 0.9}, Vec3{2, 3, 0.9}, Vec3{0, 7, 0.9}}) aside.push_back(scene.Vertex(p));
  const auto again = scene.Loop(aside);
  ASSERT_THAT(again, ::testing::Contains(above[0]));
  EXPECT_EQ(scene.Check(e[0], e[3], kStrict), Verdict::kAccepted);
}

TEST(CheckConnection, DoesNotReachTheSheetAbove) {
  Scene scene(std::make_unique<SheetsSurface>(0.3));
  const auto places = Polygon(5);
  std::vector<WindowVertexId> below, above;
  for (const Vec3& p : places) {
    below.push_back(scene.Vertex(p));
    above.push_back(scene.Vertex(p + Vec3{0, 0, 0.3}, kUp, 1, 1));
  }
  const auto e = scene.Loop(below);
  std::vector<FrontEdgeId> f = {scene.fronts.AddLoop(above)};
  while (f.size() < 5) f.push_back(scene.fronts.at(f.back()).next);
  EXPECT_EQ(scene.Check(e[0], e[3], kStrict), Verdict::kAccepted);
  EXPECT_EQ(scene.Check(e[0], f[3], kStrict), Verdict::kOffSheet);
  EXPECT_EQ(scene.Check(e[0], f[3], kStrictness[3]), Verdict::kOffSheet) << "at any strictness";
}

// Seen from above a loop around an open place runs clockwise, one around a hole in what is open counter-clockwise.
TEST(SurroundsOpenSide, TellsAnOpenPlaceFromTheHoleInASheet) {
  for (const int n : {3, 4, 7, 30}) {
    Scene scene;
    std::vector<Vec3> around = Polygon(n);
    EXPECT_TRUE(scene.proposer.SurroundsOpenSide(scene.Loop(around)[0])) << n;
    std::reverse(around.begin(), around.end());
    EXPECT_FALSE(scene.proposer.SurroundsOpenSide(scene.Loop(around)[0])) << n;
  }
}

TEST(SurroundsOpenSide, SeesThroughReflexCorners) {
  // An L, and the same as a hole.
  std::vector<Vec3> around = {{0, 0, 0}, {0, 2, 0}, {1, 2, 0}, {1, 1, 0}, {2, 1, 0}, {2, 0, 0}};
  Scene scene;
  EXPECT_TRUE(scene.proposer.SurroundsOpenSide(scene.Loop(around)[0]));
  std::reverse(around.begin(), around.end());
  EXPECT_FALSE(scene.proposer.SurroundsOpenSide(scene.Loop(around)[0]));
}

TEST(CheckConnection, DoesNotCloseALoopAroundAHole) {
  Scene scene;
  const FrontEdgeId e = scene.Loop({{0, 0, 0}, {1, 0, 0}, {0.5, 0.8, 0}})[0];
  for (const Strictness& strictness : kStrictness) {
    EXPECT_NE(scene.Check(e, scene.fronts.at(e).prev, strictness), Verdict::kAccepted);
  }
  EXPECT_EQ(scene.Check(e, scene.fronts.at(e).prev, kRegardlessOfNormals), Verdict::kOutsideSector);
}

// A front around a thin tube: what closes it across the lumen does not stand for the tube, however relaxed the tests are.
TEST(ProposeConnection, DoesNotCloseATubesLumen) {
  for (const int n : {3, 4, 5, 8}) {
    for (const Strictness& strictness : kStrictness) {
      Scene scene(std::make_unique<CylinderSurface>(1));
      std::vector<WindowVertexId> v;
      for (int i = 0; i < n; ++i) {
        const double angle = 2 * std::numbers::pi * i / n;
        const Vec3 p{std::cos(angle), std::sin(angle), 0};
        v.push_back(scene.Vertex(p, p, 2 * std::sin(std::numbers::pi / n)));
      }
      for (const FrontEdgeId e : scene.Loop(v)) {
        EXPECT_NE(scene.Propose(e, strictness), Verdict::kAccepted) << n << " edges, " << strictness.name;
        EXPECT_FALSE(scene.connection.corner.valid());
      }
    }
  }
}

TEST(ProposeConnection, TakesTheBestOfAllCorners) {
  // The corner below the edge's middle makes an equilateral triangle; its neighbours make slivers or leave them behind.
  Scene scene;
  const auto e = scene.Loop({{0, 0, 0},
                             {1, 0, 0},
                             {1.6, -0.6, 0},
                             {1.3, -1.3, 0},
                             {0.5, -std::sqrt(0.75), 0},
                             {-0.3, -1.3, 0},
                             {-0.6, -0.6, 0}});
  ASSERT_EQ(scene.Propose(e[0], kStrict), Verdict::kAccepted);
  EXPECT_EQ(scene.connection.corner, e[4]);
  EXPECT_GT(scene.connection.score, 0.5);
}

TEST(ProposeConnection, CountsTheCornersLeftBehind) {
  // Left of the edge a spike of the open side, 15° wide, would remain between the triangle and the edge before.
  const double angle = -75 * std::numbers::pi / 180;
  Scene scene;
  const auto e = scene.Loop(
      {{0, 0, 0}, {1, 0, 0}, {1.8, -0.7, 0}, {0.5, -0.87, 0}, {0.9 * std::cos(angle), 0.9 * std::sin(angle), 0}});
  ASSERT_EQ(scene.Propose(e[0], kStrictness[2]), Verdict::kAccepted);
  EXPECT_EQ(scene.connection.corner, e[4])
      << "the ear, although the triangle with the corner below the middle is rounder";
}

TEST(ProposeConnection, MergesWithAnotherLoop) {
  Scene scene;
  const FrontEdgeId e = scene.Loop(kRoomy)[0];
  const auto other = scene.Loop({{0.5, -0.9, 0}, {0.1, -1.7, 0}, {0.9, -1.7, 0}});
  ASSERT_EQ(scene.Propose(e, kStrict), Verdict::kAccepted);
  EXPECT_EQ(scene.connection.corner, other[0]);
}

TEST(ProposeConnection, DoesNotReachForAnotherSheet) {
  for (const uint32_t sheet : {0u, 1u}) {
    Scene scene;
    const FrontEdgeId e = scene.Loop(kRoomy)[0];
    std::vector<WindowVertexId> v;
    for (const Vec3& p : {Vec3{0.5, -0.9, 0}, Vec3{0.1, -1.7, 0}, Vec3{0.9, -1.7, 0}}) {
      v.push_back(scene.Vertex(p));
      scene.fronts.at(v.back()).sheet = sheet;
    }
    scene.Loop(v);
    EXPECT_EQ(scene.Propose(e, kStrict) == Verdict::kAccepted, sheet == 0);
  }
}

TEST(ProposeEar, IsALowerBoundOfWhatASearchFinds) {
  for (const int n : {4, 5}) {
    Scene scene;
    const auto e = scene.Loop(Polygon(n));
    const ConnectionProposal ear = scene.proposer.ProposeEar(e[0], kStrict);
    ASSERT_TRUE(ear.corner.valid()) << n;
    EXPECT_TRUE(ear.corner == e[n - 1] || ear.corner == e[2]) << n;
    ASSERT_EQ(scene.Propose(e[0], kStrict), Verdict::kAccepted) << n;
    EXPECT_GE(scene.connection.score, ear.score) << n;
  }
}

// On the right, the ear with the edge after is round, that with the edge before is not.
TEST(ProposeEar, LooksAtOneNeighbourAndAboveAScoreWhereAsked) {
  Scene scene;
  const auto e = scene.Loop({{0, 0, 0}, {1, 0, 0}, {0.5, -0.9, 0}, {0, -3, 0}, {-0.9, -0.9, 0}});
  using enum Proposer::Neighbour;
  const ConnectionProposal before = scene.proposer.ProposeEar(e[0], kStrictness[2], kBefore);
  const ConnectionProposal after = scene.proposer.ProposeEar(e[0], kStrictness[2], kAfter);
  EXPECT_EQ(before.corner, e[4]);
  EXPECT_EQ(after.corner, e[2]);
  ASSERT_GT(after.score, before.score);
  EXPECT_EQ(scene.proposer.ProposeEar(e[0], kStrictness[2], kEither).corner, e[2]);
  EXPECT_FALSE(scene.proposer.ProposeEar(e[0], kStrictness[2], kBefore, before.score).corner.valid());
  EXPECT_TRUE(scene.proposer.ProposeEar(e[0], kStrictness[2], kBefore, 0.9 * before.score).corner.valid());
}

// Behind a fence lies the best corner: by its shape it would do.
TEST(ProposeConnection, ByShapeAloneFindsAnUpperBound) {
  for (const bool is_fenced : {false, true}) {
    Scene scene;
    const auto e = scene.Loop({{0, 0, 0}, {1, 0, 0}, {3, -1, 0}, {0.5, -0.9, 0}, {-2, -1, 0}});
    if (is_fenced) scene.Loop({{-3, -0.45, 0}, {3, -0.45, 0}, {0, 5, 0}});
    ASSERT_EQ(scene.Propose(e[0], kStrict, Proposer::Scrutiny::kShape), Verdict::kAccepted);
    EXPECT_EQ(scene.connection.corner, e[3]) << is_fenced;
    const double bound = scene.connection.score;
    const Verdict verdict = scene.Propose(e[0], kStrict);
    EXPECT_EQ(verdict == Verdict::kAccepted, !is_fenced);
    EXPECT_LE(scene.connection.score, bound) << is_fenced;
  }
}

TEST(ProposeEar, FindsNoneWhereTheNeighboursLeadAway) {
  Scene scene;
  EXPECT_FALSE(scene.proposer.ProposeEar(scene.Loop(kRoomy)[0], kStrict).corner.valid());
}

TEST(ProposeConnection, FindsNothingWhereNothingIsNear) {
  Scene scene;
  EXPECT_NE(scene.Propose(scene.Loop(kRoomy)[0], kStrict), Verdict::kAccepted);
  EXPECT_FALSE(scene.connection.corner.valid());
}

TEST(Proposer, CountsItsVerdicts) {
  Scene scene;
  const FrontEdgeId e = scene.Loop(kRoomy)[0];
  scene.Free(e), scene.Free(e);
  EXPECT_EQ(scene.proposer.counts()[static_cast<int>(Verdict::kAccepted)], 2u);
  scene.Loop({{-3, -0.2, 0}, {3, -0.2, 0}, {0, 5, 0}});
  scene.Free(e);
  EXPECT_EQ(scene.proposer.counts()[static_cast<int>(Verdict::kCrossesFence)], 1u);
}

TEST(Proposer, HasANameForEachVerdict) {
  std::set<std::string_view> names;
  for (int i = 0; i < kVerdicts; ++i) names.insert(VerdictName(static_cast<Verdict>(i)));
  EXPECT_EQ(names.size(), static_cast<size_t>(kVerdicts));
  EXPECT_EQ(names.count(""), 0u);
}

TEST(StandsForSurface, MeasuresTheMiddleOfEachNewSideAndOfTheTriangle) {
  Scene scene(std::make_unique<SphereSurface>());
  const auto at = [&](const Vec3& x) { return static_cast<SphereSurface&>(*scene.surface).Project(x, 0); };
  const SourcePoint a = at({0, 0.3, 1}), b = at({0.3, 0, 1}), c = at({-0.3, -0.3, 1});
  EXPECT_TRUE(scene.proposer.StandsForSurface(a, b, c, true, true, 0.1)) << "(base, base, apex) as it is grown";
  EXPECT_FALSE(scene.proposer.StandsForSurface(a, b, c, true, true, 0.01)) << "too coarse for so little";
  EXPECT_FALSE(scene.proposer.StandsForSurface(b, a, c, false, false, 0.1)) << "inside out";
}

}  // namespace
}  // namespace meshfront
