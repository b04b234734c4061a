#include "core/front/front_set.h"

#include <algorithm>
#include <set>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/core/front/front_checks.h"

namespace meshfront {
namespace {

using meshfront::testing::CountLoops;
using meshfront::testing::EdgeExistsAnywhere;
using meshfront::testing::FaultOf;
using meshfront::testing::LiveEdges;
using meshfront::testing::LiveTriangles;
using meshfront::testing::MayConnect;
using meshfront::testing::RandomFronts;
using ::testing::SizeIs;
using ::testing::UnorderedElementsAreArray;

constexpr TriangleKind kConnection = TriangleKind::kConnection;

struct Fixture {
  WindowVertexId Vertex() { return fronts.AddVertex({{1.0 * ++made, 0, 0}, {0, 0, 1}}, 1, 0); }
  std::vector<WindowVertexId> Vertices(int n) {
    std::vector<WindowVertexId> v;
    for (int i = 0; i < n; ++i) v.push_back(Vertex());
    return v;
  }
  FrontEdgeId EdgeFrom(WindowVertexId v) const { return fronts.at(v).first_corner; }
  FrontEdgeId EdgeBetween(WindowVertexId u, WindowVertexId v) const {
    for (const FrontEdgeId e : LiveEdges(fronts)) {
      if (fronts.From(e) == u && fronts.To(e) == v) return e;
    }
    return {};
  }
  FrontSet fronts;
  int made = 0;
};

TEST(FrontSet, StartsFromASeedWithThreeEdgesAroundIt) {
  Fixture f;
  const auto v = f.Vertices(3);
  const FrontEdgeId e = f.fronts.AddSeed(v[0], v[1], v[2]);
  EXPECT_EQ(FaultOf(f.fronts), "");
  EXPECT_EQ(f.fronts.front_edge_count(), 3u);
  EXPECT_EQ(f.fronts.LoopLength(e, 100), 3u);
  EXPECT_TRUE(f.EdgeBetween(v[0], v[1]).valid()) << "a front runs as the half-edge it belongs to";
  EXPECT_FALSE(f.EdgeBetween(v[1], v[0]).valid());
}

TEST(FrontSet, StartsFromARimWithNothingBehindIt) {
  Fixture f;
  const auto v = f.Vertices(5);
  const FrontEdgeId e = f.fronts.AddLoop(v);
  EXPECT_EQ(FaultOf(f.fronts), "");
  EXPECT_EQ(f.fronts.triangle_count(), 0u);
  EXPECT_EQ(f.fronts.LoopLength(e, 100), 5u);
  for (const WindowVertexId id : v) EXPECT_TRUE(f.fronts.at(id).on_rim);
}

TEST(FrontSet, GrowsTheLoopByOneEdge) {
  Fixture f;
  const auto v = f.Vertices(4);
  const FrontEdgeId e = f.fronts.AddSeed(v[0], v[1], v[2]);
  const WindowVertexId a = f.fronts.From(e), b = f.fronts.To(e);
  const FrontSet::Step step = f.fronts.Grow(e, v[3]);
  EXPECT_EQ(FaultOf(f.fronts), "");
  ASSERT_EQ(step.made_count, 2);
  EXPECT_EQ(f.fronts.From(step.made[0]), a);
  EXPECT_EQ(f.fronts.To(step.made[0]), v[3]);
  EXPECT_EQ(f.fronts.To(step.made[1]), b);
  EXPECT_EQ(f.fronts.at(step.triangle).corners, (std::array<WindowVertexId, 3>{b, a, v[3]}))
      << "base end, base start, apex";
  EXPECT_EQ(f.fronts.LoopLength(step.made[0], 100), 4u);
  EXPECT_FALSE(f.EdgeBetween(a, b).valid());
}

TEST(FrontSet, CutsAnEarOnEitherSideOfTheEdge) {
  for (const bool before : {true, false}) {
    Fixture f;
    const FrontEdgeId e = f.fronts.AddLoop(f.Vertices(5));
    const FrontEdgeId corner = before ? f.fronts.at(e).prev : f.fronts.at(f.fronts.at(e).next).next;
    const FrontSet::Step step = f.fronts.Connect(e, corner, kConnection);
    EXPECT_EQ(FaultOf(f.fronts), "");
    ASSERT_EQ(step.made_count, 1);
    EXPECT_EQ(f.fronts.LoopLength(step.made[0], 100), 4u);
  }
}

TEST(FrontSet, ClosesALoopOfThree) {
  Fixture f;
  const auto v = f.Vertices(3);
  const FrontEdgeId e = f.fronts.AddLoop(v);
  const FrontSet::Step step = f.fronts.Connect(e, f.fronts.at(e).prev, TriangleKind::kClosing);
  EXPECT_EQ(FaultOf(f.fronts), "");
  EXPECT_EQ(step.made_count, 0);
  EXPECT_EQ(f.fronts.front_edge_count(), 0u);
  EXPECT_EQ(f.fronts.at(step.triangle).kind, TriangleKind::kClosing);
  for (const Link across : f.fronts.at(step.triangle).across) EXPECT_TRUE(across.is_rim());
}

TEST(FrontSet, ClosesATetrahedron) {
  Fixture f;
  const auto v = f.Vertices(4);
  FrontEdgeId e = f.fronts.AddSeed(v[0], v[1], v[2]);
  const FrontSet::Step grown = f.fronts.Grow(e, v[3]);
  e = grown.made[1];
  const FrontSet::Step ear = f.fronts.Connect(e, f.fronts.at(f.fronts.at(e).next).next, kConnection);
  EXPECT_EQ(FaultOf(f.fronts), "");
  f.fronts.Connect(ear.made[0], f.fronts.at(ear.made[0]).prev, TriangleKind::kClosing);
  EXPECT_EQ(FaultOf(f.fronts), "");
  EXPECT_EQ(f.fronts.front_edge_count(), 0u);
  EXPECT_EQ(f.fronts.triangle_count(), 4u);
  for (const WindowVertexId id : v)
    EXPECT_TRUE(f.fronts.VisitFan(id, [](WindowTriangleId, int) {})) << "closed around each vertex";
}

TEST(FrontSet, SplitsALoopAtAVertexAcross) {
  Fixture f;
  const auto v = f.Vertices(8);
  const FrontEdgeId e = f.fronts.AddLoop(v);
  const FrontSet::Step step = f.fronts.Connect(e, f.EdgeFrom(v[4]), kConnection);
  EXPECT_EQ(FaultOf(f.fronts), "");
  EXPECT_EQ(CountLoops(f.fronts), 2);
  EXPECT_EQ(f.fronts.LoopLength(step.made[0], 100) + f.fronts.LoopLength(step.made[1], 100), 9u);
}

TEST(FrontSet, MergesTwoLoopsAtAVertexOfTheOther) {
  Fixture f;
  const auto v = f.Vertices(5), w = f.Vertices(4);
  const FrontEdgeId e = f.fronts.AddLoop(v);
  f.fronts.AddLoop(w);
  const FrontSet::Step step = f.fronts.Connect(e, f.EdgeFrom(w[2]), kConnection);
  EXPECT_EQ(FaultOf(f.fronts), "");
  EXPECT_EQ(CountLoops(f.fronts), 1);
  EXPECT_EQ(f.fronts.LoopLength(step.made[0], 100), 10u);
}

TEST(FrontSet, KnowsALoopsLengthUpToTheLimit) {
  Fixture f;
  const FrontEdgeId e = f.fronts.AddLoop(f.Vertices(9));
  EXPECT_EQ(f.fronts.LoopLength(e, 4), 4u);
  EXPECT_EQ(f.fronts.LoopLength(e, 9), 9u);
}

TEST(FrontSet, TellsAnEdgesLivesApart) {
  Fixture f;
  const FrontEdgeId e = f.fronts.AddLoop(f.Vertices(3));
  const uint32_t generation = f.fronts.at(e).generation;
  EXPECT_TRUE(f.fronts.IsAlive(e, generation));
  const FrontSet::Step step = f.fronts.Grow(e, f.Vertex());
  EXPECT_FALSE(f.fronts.IsAlive(e, generation));
  EXPECT_TRUE(step.made[0] == e || step.made[1] == e) << "the slot is used again";
}

// Random growth, ears, splits, merges and handles: an oriented manifold with the fronts as its boundary after every step.
TEST(FrontSet, StaysAManifoldUnderEveryLegalStep) {
  int pinched = 0, steps = 0;
  for (uint64_t seed = 1; seed <= 20; ++seed) {
    RandomFronts random(seed);
    random.Seed(), random.Seed(), random.Loop(7);
    for (int i = 0; i < 120; ++i) {
      steps += random.Step();
      ASSERT_EQ(FaultOf(random.fronts), "") << "seed " << seed << ", step " << i;
    }
    for (uint32_t i = 0; i < random.fronts.vertex_slots(); ++i) {
      const FrontEdgeId corner = random.fronts.at(WindowVertexId(i)).first_corner;
      pinched += corner.valid() && random.fronts.at(corner).next_at_vertex.valid();
    }
  }
  EXPECT_GT(steps, 1000);
  EXPECT_GT(pinched, 50) << "the sequences were too tame to mean anything";
}

TEST(FrontSet, FindsExistingEdgesAtPinchedVerticesToo) {
  for (uint64_t seed = 1; seed <= 6; ++seed) {
    RandomFronts random(seed);
    random.Seed(), random.Loop(6);
    for (int i = 0; i < 100; ++i) random.Step();
    for (uint32_t u = 0; u < random.fronts.vertex_slots(); ++u) {
      for (uint32_t v = 0; v < random.fronts.vertex_slots(); ++v) {
        if (u == v || !random.fronts.at(WindowVertexId(u)).alive || !random.fronts.at(WindowVertexId(v)).alive)
          continue;
        ASSERT_EQ(random.fronts.EdgeExists(WindowVertexId(u), WindowVertexId(v)),
                  EdgeExistsAnywhere(random.fronts, WindowVertexId(u), WindowVertexId(v)))
            << "seed " << seed << ": " << u << " and " << v;
      }
    }
  }
}

TEST(FrontSet, TakesARandomSetOfTrianglesBack) {
  for (uint64_t seed = 1; seed <= 60; ++seed) {
    RandomFronts random(seed);
    random.Seed(), random.Loop(6);
    for (int round = 0; round < 6; ++round) {
      for (int i = 0; i < 40; ++i) random.Step();
      auto live = LiveTriangles(random.fronts);
      std::vector<WindowTriangleId> removed;
      const size_t share = 2 + random.Below(6);
      for (const WindowTriangleId t : live) {
        if (random.Below(share) == 0) removed.push_back(t);
      }
      const auto made = random.fronts.Remove(removed);
      ASSERT_EQ(FaultOf(random.fronts), "") << "seed " << seed << ", round " << round;
      ASSERT_EQ(random.fronts.triangle_count(), live.size() - removed.size());
      for (const FrontEdgeId e : made) ASSERT_TRUE(random.fronts.at(e).alive);
    }
  }
}

TEST(FrontSet, TakesBackAllButOneTriangle) {
  for (uint64_t seed = 1; seed <= 20; ++seed) {
    RandomFronts random(seed);
    random.Seed();
    for (int i = 0; i < 50; ++i) random.Step();
    auto live = LiveTriangles(random.fronts);
    const WindowTriangleId kept = live[random.Below(live.size())];
    std::erase(live, kept);
    random.fronts.Remove(live);
    ASSERT_EQ(FaultOf(random.fronts), "") << "seed " << seed;
    EXPECT_EQ(random.fronts.triangle_count(), 1u);
    EXPECT_EQ(random.fronts.front_edge_count(), 3u);
  }
}

TEST(FrontSet, TakesEverythingBackToTheRim) {
  for (uint64_t seed = 1; seed <= 20; ++seed) {
    RandomFronts random(seed);
    random.Loop(7), random.Loop(5);
    for (int i = 0; i < 60; ++i) random.Step();
    random.fronts.Remove(LiveTriangles(random.fronts));
    ASSERT_EQ(FaultOf(random.fronts), "") << "seed " << seed;
    EXPECT_EQ(random.fronts.triangle_count(), 0u);
    EXPECT_EQ(random.fronts.front_edge_count(), 12u);
    EXPECT_EQ(CountLoops(random.fronts), 2);
  }
}

TEST(FrontSet, ReportsTheEdgesThatAppearWhenTrianglesAreTakenBack) {
  RandomFronts random(7);
  random.Seed(), random.Loop(6);
  for (int i = 0; i < 80; ++i) random.Step();
  const auto before = LiveEdges(random.fronts);
  std::vector<std::pair<FrontEdgeId, uint32_t>> known;
  for (const FrontEdgeId e : before) known.push_back({e, random.fronts.at(e).generation});
  auto live = LiveTriangles(random.fronts);
  live.resize(live.size() / 2);
  const auto made = random.fronts.Remove(live);
  std::vector<FrontEdgeId> appeared;
  for (const FrontEdgeId e : LiveEdges(random.fronts)) {
    if (std::count(known.begin(), known.end(), std::pair{e, random.fronts.at(e).generation}) == 0)
      appeared.push_back(e);
  }
  EXPECT_THAT(made, UnorderedElementsAreArray(appeared));
}

// A disk: a ring of `n` triangles around a middle vertex.
struct Disk : Fixture {
  explicit Disk(int n) {
    middle = Vertex();
    const WindowVertexId first = Vertex(), second = Vertex();
    ring = {first, second};
    fronts.AddSeed(middle, first, second);
    for (int i = 2; i < n; ++i) {
      const WindowVertexId v = Vertex();
      fronts.Grow(EdgeBetween(ring.back(), middle), v);
      ring.push_back(v);
    }
    const FrontEdgeId e = EdgeBetween(ring.back(), middle);
    fronts.Connect(e, fronts.at(fronts.at(e).next).next, kConnection);
  }
  WindowTriangleId TriangleAt(int i) const {  // (middle, ring i, ring i + 1)
    for (const WindowTriangleId t : LiveTriangles(fronts)) {
      const auto& c = fronts.at(t).corners;
      const auto has = [&](WindowVertexId v) { return std::count(c.begin(), c.end(), v) > 0; };
      if (has(middle) && has(ring[i]) && has(ring[(i + 1) % ring.size()])) return t;
    }
    return {};
  }
  WindowVertexId middle;
  std::vector<WindowVertexId> ring;
};

TEST(FrontSet, TurnsAnEdge) {
  Disk disk(6);
  ASSERT_EQ(FaultOf(disk.fronts), "");
  // The edge from the middle to ring vertex 1, between triangles 0 and 1, becomes the one between ring vertices 0 and 2.
  const WindowTriangleId s = disk.TriangleAt(0), t = disk.TriangleAt(1);
  for (int side = 0; side < 3; ++side) {
    if (disk.fronts.at(s).across[side].is_half_edge() && disk.fronts.at(s).across[side].triangle() == t) {
      disk.fronts.Flip(Link::HalfEdge(s, side));
      break;
    }
  }
  EXPECT_EQ(FaultOf(disk.fronts), "");
  EXPECT_TRUE(disk.fronts.EdgeExists(disk.ring[0], disk.ring[2]));
  EXPECT_FALSE(disk.fronts.EdgeExists(disk.middle, disk.ring[1]));
  int fan = 0;
  EXPECT_TRUE(disk.fronts.VisitFan(disk.middle, [&](WindowTriangleId, int) { ++fan; }));
  EXPECT_EQ(fan, 5);
}

TEST(FrontSet, StaysAManifoldWhileRandomEdgesAreTurned) {
  int turned = 0;
  for (uint64_t seed = 1; seed <= 20; ++seed) {
    RandomFronts random(seed);
    random.Seed(), random.Loop(6);
    for (int i = 0; i < 80; ++i) {
      random.Step();
      const Link h = random.AnySide();
      if (!h.is_half_edge()) continue;
      const Link g = random.Across(h);
      if (!g.is_half_edge() || g.triangle() == h.triangle()) continue;
      const WindowVertexId c = random.Opposite(h), d = random.Opposite(g);
      if (c == d || random.fronts.EdgeExists(c, d)) continue;
      random.fronts.Flip(h);
      ++turned;
      ASSERT_EQ(FaultOf(random.fronts), "") << "seed " << seed << ", step " << i;
    }
  }
  EXPECT_GT(turned, 100);
}

TEST(FrontSet, PutsAVertexOnASideBetweenTwoTriangles) {
  Disk disk(6);
  const WindowVertexId v = disk.Vertex();
  const WindowTriangleId s = disk.TriangleAt(0);
  int side = 0;  // from the middle to ring vertex 0, or back
  while (!disk.fronts.at(s).across[side].is_half_edge() ||
         disk.fronts.at(s).across[side].triangle() != disk.TriangleAt(5))
    ++side;
  const Link from_v = disk.fronts.SplitSide(Link::HalfEdge(s, side), v);
  EXPECT_EQ(FaultOf(disk.fronts), "");
  EXPECT_EQ(disk.fronts.at(from_v.triangle()).corners[from_v.side()], v);
  EXPECT_EQ(disk.fronts.triangle_count(), 8u);
  EXPECT_EQ(disk.fronts.at(v).triangles, 4u);
  EXPECT_EQ(disk.fronts.at(disk.middle).triangles, 6u);
  EXPECT_EQ(disk.fronts.at(disk.ring[1]).triangles, 3u) << "a corner across has one more";
  EXPECT_FALSE(disk.fronts.EdgeExists(disk.middle, disk.ring[0]));
  for (const WindowVertexId u : {disk.middle, disk.ring[0], disk.ring[1], disk.ring[5]})
    EXPECT_TRUE(disk.fronts.EdgeExists(v, u));
  int fan = 0;
  EXPECT_TRUE(disk.fronts.VisitFan(v, [&](WindowTriangleId t, int) {
    ++fan;
    EXPECT_EQ(disk.fronts.at(t).kind, TriangleKind::kClosing);
  }));
  EXPECT_EQ(fan, 4);
}

TEST(FrontSet, PutsAVertexOnTheRim) {
  Fixture f;
  const auto ring = f.Vertices(3);
  const FrontEdgeId e = f.fronts.AddLoop(ring);
  const FrontSet::Step step = f.fronts.Connect(e, f.fronts.at(e).prev, TriangleKind::kClosing);
  const WindowVertexId v = f.Vertex();
  f.fronts.SplitSide(Link::HalfEdge(step.triangle, 1), v);
  EXPECT_EQ(FaultOf(f.fronts), "");
  EXPECT_TRUE(f.fronts.at(v).on_rim);
  EXPECT_EQ(f.fronts.triangle_count(), 2u);
  EXPECT_EQ(f.fronts.at(v).triangles, 2u);
}

TEST(FrontSet, PutsAVertexIntoATriangle) {
  Disk disk(5);
  const WindowVertexId v = disk.Vertex();
  disk.fronts.SplitTriangle(disk.TriangleAt(2), v);
  EXPECT_EQ(FaultOf(disk.fronts), "");
  EXPECT_EQ(disk.fronts.triangle_count(), 7u);
  EXPECT_EQ(disk.fronts.at(v).triangles, 3u);
  for (const WindowVertexId u : {disk.middle, disk.ring[2], disk.ring[3]}) EXPECT_TRUE(disk.fronts.EdgeExists(v, u));
}

TEST(FrontSet, StaysAManifoldWhileVerticesArePutIntoIt) {
  int sides = 0, rims = 0, insides = 0;
  for (uint64_t seed = 1; seed <= 20; ++seed) {
    RandomFronts random(seed);
    random.Seed(), random.Loop(6);
    for (int i = 0; i < 80; ++i) {
      random.Step();
      const Link h = random.AnySide();
      if (!h.is_half_edge()) continue;
      const Link g = random.Across(h);
      if (random.Below(3) == 0) {
        random.fronts.SplitTriangle(h.triangle(), random.NewVertex()), ++insides;
      } else if (g.is_rim()) {
        random.fronts.SplitSide(h, random.NewVertex()), ++rims;
      } else if (g.is_half_edge() && random.Opposite(h) != random.Opposite(g)) {
        random.fronts.SplitSide(h, random.NewVertex()), ++sides;
      }
      ASSERT_EQ(FaultOf(random.fronts), "") << "seed " << seed << ", step " << i;
    }
  }
  EXPECT_GT(std::min({sides, rims, insides}), 30) << sides << " " << rims << " " << insides;
}

// Gives every vertex of the triangles an output id, as the settling window does before it lets them go.
void Emit(FrontSet& fronts, const std::vector<WindowTriangleId>& triangles, uint32_t& next) {
  for (const WindowTriangleId t : triangles) {
    for (const WindowVertexId v : fronts.at(t).corners) {
      if (!fronts.at(v).emitted.valid()) fronts.at(v).emitted = VertexId(next++);
    }
  }
}

TEST(FrontSet, SettlesAVertexWhenItsLastTriangleGoes) {
  Disk disk(5);
  uint32_t next = 0;
  const auto all = LiveTriangles(disk.fronts);
  Emit(disk.fronts, all, next);
  const VertexId middle = disk.fronts.at(disk.middle).emitted;
  const std::vector<WindowTriangleId> first(all.begin(), all.end() - 1), last(all.end() - 1, all.end());
  EXPECT_THAT(disk.fronts.Settle(first), SizeIs(0)) << "the middle is still in use, the others are on the front";
  EXPECT_EQ(disk.fronts.Settle(last), std::vector<VertexId>{middle});
  EXPECT_EQ(disk.fronts.triangle_count(), 0u);
}

// Triangles that settle on both sides of a vertex leave it in two runs that know nothing of each other.
TEST(FrontSet, KeepsAVertexWhoseTrianglesSettleFromTwoSides) {
  for (int start = 0; start < 6; ++start) {
    Disk disk(6);
    uint32_t next = 0;
    std::vector<WindowTriangleId> t;
    for (int i = 0; i < 6; ++i) t.push_back(disk.TriangleAt((start + i) % 6));
    Emit(disk.fronts, t, next);
    EXPECT_THAT(disk.fronts.Settle({{t[0], t[3]}}), SizeIs(0));
    EXPECT_THAT(disk.fronts.Settle({{t[1], t[2]}}), SizeIs(0)) << "two triangles still use the vertex";
    EXPECT_TRUE(disk.fronts.at(disk.middle).alive);
    EXPECT_EQ(disk.fronts.FindViolation(), nullptr);
    EXPECT_THAT(disk.fronts.Settle({{t[4], t[5]}}), SizeIs(1));
  }
}

TEST(FrontSet, TakesAnEdgeForExistingWhenBothEndsHaveSettledTriangles) {
  Disk disk(6);
  uint32_t next = 0;
  const std::vector<WindowTriangleId> leaving = {disk.TriangleAt(0), disk.TriangleAt(3)};
  Emit(disk.fronts, leaving, next);
  disk.fronts.Settle(leaving);
  EXPECT_TRUE(disk.fronts.EdgeExists(disk.ring[0], disk.ring[3])) << "an edge between them may have been settled";
  const WindowVertexId stranger = disk.Vertex();
  disk.fronts.Grow(disk.EdgeBetween(disk.ring[1], disk.ring[2]), stranger);
  for (const WindowVertexId v : disk.ring) {
    const bool joined = v == disk.ring[1] || v == disk.ring[2];
    EXPECT_EQ(disk.fronts.EdgeExists(v, stranger), joined);
    EXPECT_EQ(disk.fronts.EdgeExists(stranger, v), joined);
  }
}

TEST(FrontSet, SettlesEveryVertexOfAClosedMeshOnce) {
  for (uint64_t seed = 1; seed <= 30; ++seed) {
    RandomFronts random(seed);
    random.Loop(5);
    for (int i = 0; i < 60; ++i) random.Step();
    while (random.fronts.front_edge_count() > 0) {  // ears until nothing is left, growing where none fits
      const FrontEdgeId e = random.AnyEdge(), corner = random.fronts.at(e).prev;
      if (MayConnect(random.fronts, e, corner))
        random.fronts.Connect(e, corner, kConnection);
      else
        random.fronts.Grow(e, random.NewVertex());
    }
    size_t vertices = 0;
    for (uint32_t i = 0; i < random.fronts.vertex_slots(); ++i) vertices += random.fronts.at(WindowVertexId(i)).alive;
    uint32_t next = 0;
    std::set<VertexId> finalised;
    for (auto live = LiveTriangles(random.fronts); !live.empty(); live = LiveTriangles(random.fronts)) {
      std::vector<WindowTriangleId> leaving;
      for (const WindowTriangleId t : live) {
        if (random.Below(4) == 0) leaving.push_back(t);
      }
      Emit(random.fronts, leaving, next);
      for (const VertexId v : random.fronts.Settle(leaving)) {
        ASSERT_TRUE(v.valid());
        ASSERT_TRUE(finalised.insert(v).second) << "vertex " << v.index() << " was finalised twice";
      }
      ASSERT_EQ(random.fronts.FindViolation(), nullptr) << "seed " << seed;
    }
    EXPECT_EQ(finalised.size(), vertices);
    EXPECT_EQ(next, vertices);
  }
}

}  // namespace
}  // namespace meshfront
