#include "core/front/refinement.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "core/geometry/triangle.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/core/front/fake_surfaces.h"
#include "tests/core/front/front_checks.h"

namespace meshfront {
namespace {

using testing::FaultOf;
using ::testing::IsEmpty;
using testing::LiveTriangles;
using ::testing::Not;
using testing::PlaneSurface;
using testing::SphereSurface;

size_t NoLimit(double /*excess*/) { return 1000; }

// A vertex that has to go back to a front is told apart by its sheet from what lies close on another.
TEST(Refinement, PutsVerticesOnTheSheetOfTheirNeighbours) {
  const SphereSurface sphere;
  for (const auto manner : {Refinement::Manner::kSides, Refinement::Manner::kWorstPlace}) {
    FrontSet fronts;
    std::vector<WindowVertexId> v;
    const auto vertex = [&](const Vec3& p) {
      v.push_back(fronts.AddVertex(sphere.Project(p, 0), 0.2, 1));
      fronts.at(v.back()).sheet = 7;
      return v.back();
    };
    for (int i = 0; i < 6; ++i) {  // clockwise: open inside
      const double angle = -std::numbers::pi / 3 * i;
      vertex({0.6 * std::cos(angle), 0.6 * std::sin(angle), 0.8});
    }
    const FrontEdgeId first = fronts.AddLoop(v);
    FrontSet::Step step = fronts.Grow(first, vertex({0, 0, 1}));
    while (fronts.front_edge_count() > 0) {
      const FrontEdgeId rim = fronts.at(step.made[step.made_count - 1]).next;
      step = fronts.Connect(rim, fronts.at(rim).prev, TriangleKind::kConnection);
    }
    Refinement refinement(sphere, fronts, 0.005, 0, 0, true);
    refinement.SetSlack(100);
    EXPECT_THAT(refinement.Refine(LiveTriangles(fronts), manner, NoLimit), IsEmpty());
    refinement.SetSlack(1);
    EXPECT_THAT(refinement.Refine(LiveTriangles(fronts), manner, [](double) { return size_t{0}; }), IsEmpty());
    EXPECT_THAT(refinement.Refine(LiveTriangles(fronts), manner, NoLimit), Not(IsEmpty()));
    EXPECT_EQ(FaultOf(fronts), "");
    for (const WindowTriangleId t : LiveTriangles(fronts)) {
      for (const WindowVertexId corner : fronts.at(t).corners) EXPECT_EQ(fronts.at(corner).sheet, 7u);
    }
  }
}

//          c
//        /   \           the triangle's side a–b cuts off a part of the round hole below it
//      a --_-- b
TEST(Refinement, PutsAVertexOnARimButNotOnACreaseThatTwoPatchesShare) {
  const PlaneSurface plane(1e30, std::sqrt(1.25), {0, -1, 0});
  for (const bool is_crease : {false, true}) {
    FrontSet fronts;
    std::vector<WindowVertexId> v;
    for (const Vec3& p : {Vec3{-0.5, 0, 0}, Vec3{0, 1, 0}, Vec3{0.5, 0, 0}})
      v.push_back(fronts.AddVertex({p, {0, 0, 1}}, 0.3, 0));
    if (is_crease) {
      fronts.AttachJoint(v[0], 0), fronts.AttachJoint(v[2], 1);
      fronts.MarkCrease(v[2], v[0]);
    }
    const FrontEdgeId e = fronts.AddLoop(v);
    fronts.Connect(e, fronts.at(e).prev, TriangleKind::kClosing);
    Refinement refinement(plane, fronts, 0.01, 0, 0, true);
    const auto made = refinement.Refine(LiveTriangles(fronts), Refinement::Manner::kSides, NoLimit);
    EXPECT_EQ(FaultOf(fronts), "");
    EXPECT_EQ(made.empty(), is_crease);
    EXPECT_EQ(refinement.rim_insertions(), is_crease ? 0u : 1u);
    EXPECT_EQ(fronts.triangle_count(), is_crease ? 1u : 2u);
  }
}

// One triangle over a sphere's cap, off by much more than the bound.
TEST(Refinement, EnclosesADeviationToATwentiethUnlessSomethingLargerIsKnown) {
  const SphereSurface sphere;
  FrontSet fronts;
  std::vector<WindowVertexId> v;
  for (int i = 0; i < 3; ++i) {
    const double angle = -2 * std::numbers::pi / 3 * i;
    v.push_back(fronts.AddVertex(sphere.Project({0.6 * std::cos(angle), 0.6 * std::sin(angle), 0.8}, 0), 1, 1));
  }
  const FrontEdgeId e = fronts.AddLoop(v);
  fronts.Connect(e, fronts.at(e).prev, TriangleKind::kClosing);
  const WindowTriangleId t = LiveTriangles(fronts)[0];
  Refinement refinement(sphere, fronts, 0.005, 0, 0, true);
  const auto enclosed = [&](double known) {
    fronts.at(t).deviation = 0.01;
    refinement.Enclose(t, known);
    return fronts.at(t).deviation;
  };
  const double within = enclosed(0);  // 1 − cos 37° = 0.2
  EXPECT_GE(within, 0.2);
  EXPECT_LE(within, 0.2 * 1.05 * 1.05);
  EXPECT_EQ(enclosed(0.1), within);
  EXPECT_EQ(enclosed(within), within);
  EXPECT_GT(enclosed(0.5), within);  // is not told apart from what is known …
  EXPECT_LE(enclosed(0.5), 0.5);     // … but never counts as more
}

TEST(Refinement, MovesNoVertexOutOfTheBound) {
  const SphereSurface sphere;
  FrontSet fronts;
  std::vector<WindowVertexId> v;
  for (int i = 0; i < 6; ++i) {
    const double angle = -std::numbers::pi / 3 * i;
    v.push_back(fronts.AddVertex(sphere.Project({0.2 * std::cos(angle), 0.2 * std::sin(angle), 1}, 0), 0.2, 1));
  }
  const WindowVertexId middle = fronts.AddVertex(sphere.Project({0, 0, 1}, 0), 0.2, 1);
  FrontSet::Step step = fronts.Grow(fronts.AddLoop(v), middle);
  while (fronts.front_edge_count() > 0) {
    const FrontEdgeId rim = fronts.at(step.made[step.made_count - 1]).next;
    step = fronts.Connect(rim, fronts.at(rim).prev, TriangleKind::kConnection);
  }
  Refinement refinement(sphere, fronts, 0.02, 0, 0, true);
  for (const WindowTriangleId t : LiveTriangles(fronts)) EXPECT_TRUE(refinement.Measure(t).is_kept);
  EXPECT_FALSE(refinement.TryMove(middle, {0, 0, 1.03}));
  EXPECT_EQ(fronts.at(middle).position, Vec3(0, 0, 1));
  EXPECT_TRUE(refinement.TryMove(middle, {0, 0, 1.01}));
  EXPECT_EQ(fronts.at(middle).position, Vec3(0, 0, 1.01));
}

// A sphere that counts the walks over it.
class WalkedSphere : public SphereSurface {
 public:
  using SphereSurface::SphereSurface;
  SourcePoint Snap(const SourcePoint& start, const Vec3& target) const override {
    ++walks_;
    return SphereSurface::Snap(start, target);
  }
  int walks() const { return walks_; }

 private:
  mutable int walks_ = 0;
};

// A triangle on a sphere's cap, measured again as it is, moved, moved back, and against another bound.
TEST(Refinement, WalksAgainForWhatHasChangedOnly) {
  const WalkedSphere sphere;
  FrontSet fronts;
  std::vector<WindowVertexId> v;
  for (int i = 0; i < 3; ++i) {
    const double angle = -2 * std::numbers::pi / 3 * i;
    v.push_back(fronts.AddVertex(sphere.Project({0.2 * std::cos(angle), 0.2 * std::sin(angle), 1}, 0), 1, 1));
  }
  const FrontEdgeId e = fronts.AddLoop(v);
  fronts.Connect(e, fronts.at(e).prev, TriangleKind::kClosing);
  const WindowTriangleId t = LiveTriangles(fronts)[0];
  Refinement refinement(sphere, fronts, 0.05, 0, 0, true);
  const auto is_kept_after_walks = [&](bool walks) {
    const int before = sphere.walks();
    const bool is_kept = refinement.Measure(t).is_kept;
    EXPECT_EQ(sphere.walks() > before, walks);
    return is_kept;
  };
  EXPECT_TRUE(is_kept_after_walks(true));
  EXPECT_TRUE(is_kept_after_walks(false));
  const Vec3 place = fronts.at(v[1]).position;
  fronts.at(v[1]).position = 1.02 * place;
  EXPECT_TRUE(is_kept_after_walks(true));
  EXPECT_TRUE(is_kept_after_walks(false));
  fronts.at(v[1]).position = 1.2 * place;
  EXPECT_FALSE(refinement.Measure(t).is_kept);  // the corner tells, without a walk
  fronts.at(v[1]).position = place;
  EXPECT_TRUE(is_kept_after_walks(true));
  refinement.SetSlack(0.1);  // the middle is 0.02 below the sphere
  EXPECT_FALSE(is_kept_after_walks(true));
}

// A plane that tells of one place over each triangle, whatever lies there.
class FoldedPlane : public PlaneSurface {
 public:
  explicit FoldedPlane(const Vec3& above) : above_(above) {}
  bool FindFarPlaces(const SourcePoint&, const std::array<Vec3, 3>& triangle, double, double,
                     std::vector<FarPlace>& far, std::vector<DoubtfulPart>* doubtful) const override {
    if (doubtful) doubtful->clear();
    far = {{(triangle[0] + triangle[1] + triangle[2]) / 3.0, {above_, {0, 0, 1}}, true, true}};
    return true;
  }

 private:
  Vec3 above_;
};

//     1 --- 3 --- 5 __
//    /  \  /  \  /     \       a strip of triangles, seen from the side: it leads away, up and back
//   0 --- 2 --- 4 --- 6
TEST(Refinement, FindsThatAPlaceOverATriangleBelongsToOthersSomeTrianglesAway) {
  const auto is_kept = [](const Vec3& above) {
    const FoldedPlane surface(above);
    FrontSet fronts;
    std::vector<WindowVertexId> v;
    const auto vertex = [&](double x, double y, double z) {
      v.push_back(fronts.AddVertex({{x, y, z}, {0, 0, 1}}, 1, 1));
    };
    for (int i = 0; i < 5; ++i) vertex(0.5 * i, i % 2, 0);
    for (int i = 5; i > 0; --i) vertex(0.5 * i, i % 2, 0.4);
    fronts.AddSeed(v[0], v[2], v[1]);
    for (size_t i = 3; i < v.size(); ++i) {
      FrontEdgeId last = fronts.FindEdge(v[i - 2], v[i - 1]);
      if (!last.valid()) last = fronts.FindEdge(v[i - 1], v[i - 2]);
      fronts.Grow(last, v[i]);
    }
    EXPECT_EQ(FaultOf(fronts), "");
    return Refinement(surface, fronts, 0.2, 0, 0, true).Measure(LiveTriangles(fronts)[0]).is_kept;
  };
  EXPECT_TRUE(is_kept({0.7, 0.5, 0.4})) << "on the strip's other end";
  EXPECT_FALSE(is_kept({0.7, 0.5, 0.8})) << "on nothing";
}

// However many vertices there are, one place stays as far away.
TEST(Refinement, GivesUpToComeNearerToAPlaceThatNoVertexComesNearerTo) {
  const FoldedPlane surface({0.5, 0.4, 0.8});
  FrontSet fronts;
  std::vector<WindowVertexId> v;
  for (int i = 0; i < 6; ++i) {  // clockwise: open inside
    const double angle = -std::numbers::pi / 3 * i;
    v.push_back(fronts.AddVertex({{std::cos(angle), std::sin(angle), 0}, {0, 0, 1}}, 1, 1));
  }
  FrontSet::Step step = fronts.Grow(fronts.AddLoop(v), fronts.AddVertex({{0, 0, 0}, {0, 0, 1}}, 1, 1));
  while (fronts.front_edge_count() > 0) {
    const FrontEdgeId rim = fronts.at(step.made[step.made_count - 1]).next;
    step = fronts.Connect(rim, fronts.at(rim).prev, TriangleKind::kConnection);
  }
  Refinement refinement(surface, fronts, 0.2, 0, 0, true);
  size_t made = 0;
  for (int round = 0; round < 40; ++round)
    made += refinement.Refine(LiveTriangles(fronts), Refinement::Manner::kAnyShape, NoLimit).size();
  EXPECT_GT(made, 0u);
  EXPECT_LE(made, 12u);
  EXPECT_TRUE(refinement.Refine(LiveTriangles(fronts), Refinement::Manner::kAnyShape, NoLimit).empty());
}

//     f ------- e
//    /  \    /   \         a, b and c are a rim that turns in at b, where two triangles of 120 degrees meet: no place of p makes
//   g --- p ------ d       both round. A side turned to b does, once p has moved.
//    \  / | \   /
//     a _ b _ c
TEST(Refinement, TurnsASideToAVertexThatHasTooFewWhereThatIsRounderOnceOthersHaveMoved) {
  const PlaneSurface plane;
  FrontSet fronts;
  std::vector<WindowVertexId> rim;
  const auto vertex = [&](double x, double y) { return fronts.AddVertex({{x, y, 0}, {0, 0, 1}}, 0.7, 0); };
  for (const auto& [x, y] :
       {std::pair{-0.433, -0.25}, {-1.0, 0.3}, {-0.5, 1.0}, {0.5, 1.0}, {1.0, 0.3}, {0.433, -0.25}, {0.0, 0.0}})
    rim.push_back(vertex(x, y));
  const WindowVertexId p = vertex(0, 0.5);
  FrontSet::Step step = fronts.Grow(fronts.AddLoop(rim), p);
  while (fronts.front_edge_count() > 0) {
    const FrontEdgeId next = fronts.at(step.made[step.made_count - 1]).next;
    step = fronts.Connect(next, fronts.at(next).prev, TriangleKind::kConnection);
  }
  const auto worst = [&] {
    double least = 1;
    for (const WindowTriangleId t : LiveTriangles(fronts)) {
      const auto& c = fronts.at(t).corners;
      least =
          std::min(least, RadiusRatio(fronts.at(c[0]).position, fronts.at(c[1]).position, fronts.at(c[2]).position));
    }
    return least;
  };
  Refinement refinement(plane, fronts, 0.1, 0, 0, false);
  refinement.RoundOff(std::vector{p});
  EXPECT_LT(worst(), 0.5);
  refinement.TurnAway(LiveTriangles(fronts));
  EXPECT_GT(worst(), 0.59);
  EXPECT_EQ(FaultOf(fronts), "");
  const Vec3 before = fronts.at(p).position;
  refinement.TurnAway(LiveTriangles(fronts));
  EXPECT_EQ(fronts.at(p).position, before) << "what makes nothing rounder is taken back";
}

}  // namespace
}  // namespace meshfront
