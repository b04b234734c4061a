#include "core/mesh/hole_filling.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <random>
#include <vector>

#include "core/mesh/hole_patch.h"
#include "core/mesh/repair.h"
#include "core/mesh/topology.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/support/matchers.h"
#include "tests/support/shapes.h"

namespace meshfront::testing {
namespace {

FilledHoles Filled(TriangleMesh& mesh, double size) {
  FaceAdjacency adjacency = CreateAdjacency(mesh);
  const absl::StatusOr<FilledHoles> result = FillHoles(size, mesh, adjacency, Context{});
  EXPECT_TRUE(result.ok()) << result.status();
  EXPECT_EQ(adjacency.opposite.size(), mesh.triangles.size());
  return result.ok() ? *result : FilledHoles();
}

// A unit sphere without what lies within `radius` of its pole.
TriangleMesh SphereWithHole(double radius) {
  return Clipped(Icosphere(4), [=](const Vec3& x) { return radius - Distance(x, {0, 0, 1}); });
}

TEST(FillHoles, GoesOnAsTheSurfaceDoes) {
  for (const double radius : {0.15, 0.4, 0.8}) {
    TriangleMesh mesh = SphereWithHole(radius);
    const size_t before = mesh.positions.size();
    const FilledHoles holes = Filled(mesh, 2 * radius);
    EXPECT_EQ(holes.filled, 1u) << radius;
    EXPECT_THAT(holes.left_open, ::testing::IsEmpty());
    EXPECT_THAT(mesh, IsClosedManifold()) << radius;
    EXPECT_THAT(mesh, HasNoSelfIntersection()) << radius;
    double farthest = 0;
    for (size_t v = before; v < mesh.positions.size(); ++v)
      farthest = std::max(farthest, std::abs(Norm(mesh.positions[v]) - 1));
    EXPECT_LE(farthest, 0.15 * radius * radius + 0.003) << radius;  // a flat one is up to half of radius² away
  }
}

// A sheet without the cells of a grid that are named; holes that touch at a corner are one loop then, after repair.
TriangleMesh SheetWithout(int n, const std::vector<std::array<int, 2>>& cells) {
  TriangleMesh sheet = Sheet(n);
  std::erase_if(sheet.triangles, [&](const Triangle& t) {
    Vec3 middle;
    for (const VertexId v : t) middle += sheet.PositionAt(v) / 3.0;
    const Box3 box = BoundingBox(sheet);
    const auto cell = [&](double x, double from, double to) { return static_cast<int>(n * (x - from) / (to - from)); };
    const std::array<int, 2> at = {cell(middle.x, box.min.x, box.max.x), cell(middle.y, box.min.y, box.max.y)};
    return std::find(cells.begin(), cells.end(), at) != cells.end();
  });
  absl::StatusOr<RepairResult> repaired = RepairMesh(std::move(sheet), {});
  EXPECT_TRUE(repaired.ok());
  return std::move(repaired->mesh);
}

TEST(FillHoles, PartsHolesThatTouchAtAVertex) {
  const double cell = 1.5 * Distance(Sheet(10).positions[0], Sheet(10).positions[1]);
  const std::vector<std::vector<std::array<int, 2>>> cases = {
      {{3, 3}, {4, 4}}, {{3, 3}, {4, 4}, {5, 5}, {6, 4}}, {{3, 3}, {5, 3}, {4, 4}, {3, 5}, {5, 5}}};
  for (const auto& cells : cases) {
    TriangleMesh mesh = SheetWithout(10, cells);
    ASSERT_GT(mesh.positions.size(), Sheet(10).positions.size()) << "no copies of a vertex";
    const FilledHoles holes = Filled(mesh, cell);
    EXPECT_EQ(holes.filled, cells.size());
    EXPECT_THAT(holes.left_open, ::testing::IsEmpty());
    EXPECT_EQ(mesh.positions.size(), Sheet(10).positions.size() + cells.size()) << "no copies, and one in each patch";
    EXPECT_THAT(mesh, HasBoundaryLoops(1));
    EXPECT_THAT(mesh, IsManifold());
    EXPECT_THAT(mesh, HasNoSelfIntersection());
  }
}

TEST(FillHoles, FillsTheSmallerOfTwoHolesThatTouch) {
  TriangleMesh mesh = SheetWithout(12, {{3, 3}, {4, 4}, {5, 4}, {4, 5}, {5, 5}});
  const FilledHoles holes = Filled(mesh, 1.5 * Distance(Sheet(12).positions[0], Sheet(12).positions[1]));
  EXPECT_EQ(holes.filled, 1u);
  EXPECT_THAT(mesh, HasBoundaryLoops(2));
  EXPECT_THAT(mesh, IsManifold());
}

// P is there twice, and both copies have an edge to x: as one vertex they would have an edge of four triangles.
//
//      b───────c
//      │ \   / │
//      P───x───P
//       \  │\  /
//        \ a d/
TEST(FillHoles, LeavesCopiesApartWhoseEdgesWouldBeOne) {
  TriangleMesh mesh;
  mesh.positions = {{0, 0, 0}, {0, 0, 0}, {1, 0, 0}, {0.5, 1, 0}, {0.5, 0.5, 1}, {0.5, -0.5, 1}, {0.5, -1, 0}};
  const VertexId p(0), copy(1), x(2), a(3), b(4), c(5), d(6);
  mesh.triangles = {{p, x, a}, {x, p, b}, {x, b, c}, {x, c, copy}, {x, copy, d}};
  ASSERT_THAT(mesh, IsManifold());
  Filled(mesh, 9);
  EXPECT_THAT(mesh, IsManifold());
}

// The hole P y z w, beside which the mesh has the triangle z w P at the other copy of P: its side P–z is no side of a patch.
TEST(FillHoles, MakesNoEdgeThatAnotherCopyHas) {
  TriangleMesh mesh;
  mesh.positions = {{0, 0, 0}, {0, 0, 0}, {0.5, 1, 0}, {1, 0, 0}, {0.5, -0.1, 0.5}, {0.5, -1, 0}, {-1, 0.5, -1}};
  const VertexId p(0), copy(1), y(2), z(3), w(4), q(5), r(6);
  mesh.triangles = {{z, w, copy}, {z, copy, q}, {y, z, q}, {y, q, r}, {p, y, r}};
  ASSERT_THAT(mesh, IsManifold());
  EXPECT_EQ(Filled(mesh, 1.5).filled, 1u);
  EXPECT_THAT(mesh, IsManifold());
}

// A sheet that has lost triangles here and there, so that holes touch, and what is left sticks out into them.
TEST(FillHoles, FillsRaggedHolesThatTouch) {
  uint64_t pinched = 0, open = 0, all = 0;
  for (uint64_t seed = 1; seed <= 15; ++seed) {
    std::mt19937_64 random(seed);
    TriangleMesh sheet = WithNoise(Sheet(12), 0.02, seed);
    std::erase_if(sheet.triangles, [&](const Triangle& t) {
      const bool is_inside = std::all_of(t.begin(), t.end(), [&](VertexId v) {
        return std::abs(sheet.PositionAt(v).x) < 0.9 && std::abs(sheet.PositionAt(v).y) < 0.9;
      });
      return is_inside && random() % 6 == 0;
    });
    const size_t before = sheet.positions.size();
    absl::StatusOr<RepairResult> repaired = RepairMesh(std::move(sheet), {});
    ASSERT_TRUE(repaired.ok());
    TriangleMesh mesh = std::move(repaired->mesh);
    if (MeasureTopology(mesh).components > 1) continue;
    pinched += mesh.positions.size() > before;
    const FilledHoles holes = Filled(mesh, 1.5);
    all += holes.filled + holes.left_open.size(), open += holes.left_open.size();
    EXPECT_THAT(mesh, IsManifold()) << seed;
    EXPECT_THAT(mesh, HasNoSelfIntersection()) << seed;
    if (holes.left_open.empty()) {
      EXPECT_THAT(mesh, HasBoundaryLoops(1)) << seed;
    }
  }
  EXPECT_GT(pinched, 3u);
  EXPECT_EQ(open, 0u) << "of " << all;
}

// Loops whose triangles would be those that are there, or edges a second time.
TEST(FillHoles, LeavesLoopsOpenThatHaveNoPatch) {
  TriangleMesh triangle;
  triangle.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  triangle.triangles = {{VertexId(0), VertexId(1), VertexId(2)}};
  EXPECT_THAT(Filled(triangle, 9).left_open, ::testing::SizeIs(1));
  TriangleMesh sheet = Sheet(4);
  EXPECT_THAT(Filled(sheet, 9).left_open, ::testing::SizeIs(1));
  EXPECT_EQ(sheet.triangles.size(), 32u);
}

TEST(FillHoles, TakesTheDiameterOfALoopForItsSize) {
  const TriangleMesh sheet = WithoutUnreferenced(Clipped(Sheet(40), [](const Vec3& x) {
    return std::min(0.3 - std::abs(x.x + x.y), 0.05 - std::abs(x.x - x.y));  // a slot along a diagonal
  }));
  TriangleMesh smaller = sheet, larger = sheet;
  EXPECT_EQ(Filled(smaller, 0.40).filled, 0u);
  EXPECT_EQ(Filled(larger, 0.44).filled, 1u);
  EXPECT_THAT(larger, HasBoundaryLoops(1));
}

TEST(FillHoles, ClosesLongAndRaggedLoopsAndManyOfThem) {
  TriangleMesh wavy = Clipped(UvSphere(400, 200), [](const Vec3& x) {
    return 0.5 + 0.05 * std::sin(12 * std::atan2(x.y, x.x)) - Distance(x, {0, 0, 1});
  });
  EXPECT_EQ(Filled(wavy, 1.2).filled, 1u);  // some 400 edges
  EXPECT_THAT(wavy, IsClosedManifold());
  EXPECT_THAT(wavy, HasNoSelfIntersection());
  TriangleMesh pierced = Icosphere(4);
  std::vector<bool> dropped(pierced.triangles.size()), is_used(pierced.positions.size());
  for (size_t f = 0; f < dropped.size(); f += 41) {
    const Triangle& t = pierced.triangles[f];
    dropped[f] = std::none_of(t.begin(), t.end(), [&](VertexId v) { return is_used[v.index()]; });
    for (const VertexId v : t) is_used[v.index()] = true;
  }
  DropTriangles(pierced, dropped);
  EXPECT_GE(Filled(pierced, 0.3).filled, 100u);
  EXPECT_THAT(pierced, IsClosedManifold());
}

TEST(FillHoles, HoldsOnWhereTheContextStops) {
  TriangleMesh mesh = SphereWithHole(0.4);
  FaceAdjacency adjacency = CreateAdjacency(mesh);
  const std::atomic<bool> stop = true;
  Context context;
  context.stop = &stop;
  EXPECT_FALSE(FillHoles(9, mesh, adjacency, context).ok());
}

}  // namespace
}  // namespace meshfront::testing
