#include "core/features/boundary.h"

#include <atomic>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/support/shapes.h"

namespace meshfront {
namespace {

using ::testing::IsEmpty;
using ::testing::SizeIs;

std::unique_ptr<MeshSurface> SurfaceOf(TriangleMesh mesh) {
  auto surface = MeshSurface::Create(std::move(mesh), {});
  EXPECT_TRUE(surface.ok()) << surface.status();
  return *std::move(surface);
}

GuidanceField Uniform(double length) { return *GuidanceField::Create({}, {1.2, 0, length}, {}); }

std::vector<OrientedLoop> LoopsOf(const MeshSurface& surface, const GuidanceField& field) {
  auto loops = BoundaryLoops(surface, field, {});
  EXPECT_TRUE(loops.ok()) << loops.status();
  return *std::move(loops);
}

// The sum of the cross products along the loop: twice its area, towards the viewer who sees it run counter-clockwise.
Vec3 AreaOf(const OrientedLoop& loop) {
  Vec3 area;
  for (size_t i = 0; i < loop.points.size(); ++i) {
    area += Cross(loop.points[i].position, loop.points[(i + 1) % loop.points.size()].position);
  }
  return area;
}

TEST(BoundaryLoops, AreNoneOnAClosedMesh) {
  EXPECT_THAT(LoopsOf(*SurfaceOf(testing::Icosphere(2)), Uniform(0.1)), IsEmpty());
}

TEST(BoundaryLoops, AreOnePerRimOfADiskWithHoles) {
  const auto surface = SurfaceOf(testing::DiskWithHoles(60, 3));
  const auto loops = LoopsOf(*surface, Uniform(0.05));
  ASSERT_THAT(loops, SizeIs(4));
  for (const OrientedLoop& loop : loops) {
    EXPECT_GE(loop.points.size(), 15);
    for (const SourcePoint& p : loop.points) EXPECT_TRUE(surface->IsOnBoundary(p));
  }
}

TEST(BoundaryLoops, HaveTheSurfaceOnTheirRight) {
  // A sheet facing up: seen from above its rim runs clockwise; a hole in it counter-clockwise.
  const auto loops = LoopsOf(*SurfaceOf(testing::DiskWithHoles(60, 1)), Uniform(0.05));
  ASSERT_THAT(loops, SizeIs(2));
  for (const OrientedLoop& loop : loops) {
    const bool is_outer = std::abs(AreaOf(loop).z) > 2;
    EXPECT_EQ(AreaOf(loop).z < 0, is_outer);
    // The open side of every edge, towards (b − a) × n, points into the surface: that is, off the hole, or into the disk.
    Vec3 center;
    for (const SourcePoint& p : loop.points) center += p.position / static_cast<double>(loop.points.size());
    for (size_t i = 0; i < loop.points.size(); ++i) {
      const SourcePoint &a = loop.points[i], &b = loop.points[(i + 1) % loop.points.size()];
      const Vec3 inward = Cross(b.position - a.position, a.normal);
      EXPECT_EQ(Dot(inward, center - a.position) > 0, is_outer);
    }
  }
}

TEST(BoundaryLoops, KeepTheCornersOfASheetExactly) {
  const auto loops = LoopsOf(*SurfaceOf(testing::Sheet(10)), Uniform(0.23));
  ASSERT_THAT(loops, SizeIs(1));
  EXPECT_THAT(loops[0].points, SizeIs(36));
  for (const Vec3& corner : std::vector<Vec3>{{1, 1, 0}, {-1, 1, 0}, {-1, -1, 0}, {1, -1, 0}}) {
    EXPECT_EQ(std::count_if(loops[0].points.begin(), loops[0].points.end(),
                            [&](const SourcePoint& p) { return p.position == corner; }),
              1);
  }
}

TEST(BoundaryLoops, KeepAtLeastThreeVerticesOfATinyHole) {
  TriangleMesh mesh = testing::Sheet(20);
  mesh.triangles.erase(mesh.triangles.begin() + 420);  // one of 800: a hole of three edges
  const auto surface = SurfaceOf(std::move(mesh));
  const auto loops = LoopsOf(*surface, Uniform(0.5));
  ASSERT_THAT(loops, SizeIs(2));
  for (const OrientedLoop& loop : loops) {
    EXPECT_GE(loop.points.size(), 3);
    EXPECT_GT(Norm(AreaOf(loop)), 0);
  }
}

TEST(BoundaryLoops, EndOnRimsThatTouchAtAVertex) {
  // Two opposite quads around one inner vertex removed: the vertex is pinched, two fans meet there.
  TriangleMesh mesh = testing::Sheet(6);
  std::erase_if(mesh.triangles, [&](const Triangle& t) {
    Vec3 c;
    for (VertexId v : t) c += mesh.PositionAt(v) / 3.0;
    return c.x * c.y > 0 && std::abs(c.x) < 0.34 && std::abs(c.y) < 0.34;
  });
  const auto surface = SurfaceOf(testing::WithoutUnreferenced(mesh));
  for (double g : {0.05, 0.2, 2.0}) {
    for (const OrientedLoop& loop : LoopsOf(*surface, Uniform(g))) EXPECT_GE(loop.points.size(), 3);
  }
}

TEST(BoundaryLoops, FollowTheFieldOfTheRimsOwnCurvature) {
  // A disk with holes of radius 0.15: at rho 0.5 the field at a hole's rim is the chord that subtends 0.5 / 1.2, so about 15 edges.
  const auto surface = SurfaceOf(testing::DiskWithHoles(60, 2));
  auto samples = BoundarySizingSamples(*surface, [](double curvature) { return IdealLength(0.5, curvature); }, {});
  ASSERT_TRUE(samples.ok());
  const GuidanceField field = *GuidanceField::Create(*samples, {1.2, 0.001, 10}, {});
  for (const OrientedLoop& loop : LoopsOf(*surface, field)) {
    EXPECT_GT(loop.points.size(), 12);
    const bool is_outer = std::abs(AreaOf(loop).z) > 2;  // longer, and fine near the holes
    EXPECT_LT(loop.points.size(), is_outer ? 60 : 30);   // the rim's edges, up to 0.055, are as long as g
    size_t near = 0;
    for (size_t i = 0; i < loop.points.size(); ++i) {
      const Vec3 &a = loop.points[i].position, &b = loop.points[(i + 1) % loop.points.size()].position;
      const double ratio = Distance(a, b) / field.At(a);
      near += ratio > 1 / 1.2 && ratio < 1.2;
    }
    EXPECT_GE(near, 0.8 * loop.points.size());
  }
}

TEST(BoundarySizing, BoundsTheLengthAtATinyRimByAQuarterOfIt) {
  TriangleMesh mesh = testing::Sheet(20);
  mesh.triangles.erase(mesh.triangles.begin() + 420);
  const auto surface = SurfaceOf(std::move(mesh));
  auto samples = BoundarySizingSamples(*surface, [](double) { return std::numeric_limits<double>::infinity(); }, {});
  ASSERT_TRUE(samples.ok());
  ASSERT_THAT(*samples, SizeIs(83));  // 80 on the sheet's rim, 3 on the hole's
  size_t tiny = 0;
  for (const SizingSample& s : *samples) tiny += s.ideal_length < 0.1 * (2 + std::sqrt(2.0)) / 4 + 1e-12;
  EXPECT_EQ(tiny, 3);
}

TEST(BoundarySizing, IsFlatAlongStraightSides) {
  const auto surface = SurfaceOf(testing::Sheet(20));
  auto samples = BoundarySizingSamples(*surface, [](double curvature) { return IdealLength(0.5, curvature); }, {});
  for (const SizingSample& s : *samples) EXPECT_NEAR(s.ideal_length, 2, 1e-12);  // a quarter of the rim
}

TEST(BoundaryLoops, StopWhenTheContextSaysSo) {
  const std::atomic<bool> stop = true;
  Context context;
  context.stop = &stop;
  const auto surface = SurfaceOf(testing::Sheet(5));
  EXPECT_EQ(BoundaryLoops(*surface, Uniform(0.1), context).status().code(), absl::StatusCode::kCancelled);
}

}  // namespace
}  // namespace meshfront
