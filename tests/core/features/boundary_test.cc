#include "core/features/boundary.h"

#include <atomic>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/core/features/crease_surfaces.h"
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

constexpr double kAnySagitta = std::numeric_limits<double>::infinity();

GuidanceField Uniform(double length) { return *GuidanceField::Create({}, {1.2, 0, length}, {}); }

std::vector<OrientedLoop> LoopsOf(const MeshSurface& surface, const GuidanceField& field) {
  auto loops = BoundaryLoops(surface, field, {kAnySagitta}, {});
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

// --- Creases ---------------------------------------------------------------------------------------------------------------

struct CreasedShape {
  const char* name;
  TriangleMesh mesh;
  int patches;
};

std::vector<CreasedShape> CreasedShapes() {
  return {{"cube of twelve triangles", testing::Cube(1), 6},
          {"cube", testing::Cube(7), 6},
          {"capped cylinder", testing::CappedCylinder(1, 2, 24, 6), 3},
          {"half disk", testing::HalfDiskPrism(), 4},
          {"drop", testing::DropPrism(), 3},
          {"pillow", testing::Pillow(), 2},
          {"roof", testing::Roof(10), 2},
          {"open box", testing::OpenBox(5), 5},
          {"plate with a hole", testing::PlateWithRoundHole(20), 7}};
}

// An edge of the output, by the numbers of its joints.
using JointEdge = std::pair<uint32_t, uint32_t>;

// The edges on creases, in the direction of their loop. Points of one joint must agree in every bit, those of two must differ.
std::set<JointEdge> CreaseEdges(const std::vector<OrientedLoop>& loops) {
  std::set<JointEdge> edges;
  std::map<uint32_t, Vec3> places;
  for (const OrientedLoop& loop : loops) {
    const size_t n = loop.points.size();
    EXPECT_GE(n, 3u);
    EXPECT_EQ(loop.joints.empty(), loop.creases.empty());
    for (size_t i = 0; i < loop.joints.size(); ++i) {
      const uint32_t joint = loop.joints[i], next = loop.joints[(i + 1) % n];
      if (joint != kNoJoint) {
        EXPECT_EQ(places.try_emplace(joint, loop.points[i].position).first->second, loop.points[i].position);
      }
      if (!loop.creases[i]) continue;
      EXPECT_NE(joint, kNoJoint);
      EXPECT_NE(next, kNoJoint);
      EXPECT_TRUE(edges.insert({joint, next}).second) << "two loops run the same way along an edge";
    }
  }
  std::set<std::tuple<double, double, double>> different;
  for (const auto& [joint, p] : places) EXPECT_TRUE(different.insert({p.x, p.y, p.z}).second) << "joint " << joint;
  return edges;
}

TEST(BoundaryLoops, HaveTheSamePointsOnBothSidesOfACrease) {
  for (const CreasedShape& shape : CreasedShapes()) {
    const auto surface = testing::CreasedSurfaceOf(shape.mesh);
    ASSERT_EQ(surface->component_count(), static_cast<size_t>(shape.patches)) << shape.name;
    for (const double g : {0.07, 0.31, 1.0, 1e3}) {
      SCOPED_TRACE(std::string(shape.name) + " at " + std::to_string(g));
      const std::set<JointEdge> edges = CreaseEdges(LoopsOf(*surface, Uniform(g)));
      EXPECT_THAT(edges, ::testing::Not(IsEmpty()));
      for (const auto& [from, to] : edges) {
        EXPECT_TRUE(edges.contains({to, from})) << "the other side runs against it";
        EXPECT_NE(from, to);
      }
    }
  }
}

TEST(BoundaryLoops, LieOnTheirPatch) {
  for (const CreasedShape& shape : CreasedShapes()) {
    const auto surface = testing::CreasedSurfaceOf(shape.mesh);
    for (const OrientedLoop& loop : LoopsOf(*surface, Uniform(0.31))) {
      for (const SourcePoint& p : loop.points) {
        EXPECT_EQ(surface->SheetOf(p), surface->SheetOf(loop.points[0])) << shape.name;
        EXPECT_TRUE(surface->IsOnBoundary(p)) << shape.name;
        const SourcePoint on_face = surface->AtFace(FaceId(p.patch), p.u, p.v);
        EXPECT_LT(Distance(on_face.position, p.position), 1e-14) << shape.name;
      }
    }
  }
}

TEST(BoundaryLoops, HaveThePatchOnTheirRight) {
  const auto surface = testing::CreasedSurfaceOf(testing::Cube(5));
  for (const OrientedLoop& loop : LoopsOf(*surface, Uniform(0.3))) {
    EXPECT_LT(Dot(AreaOf(loop), loop.points[0].normal), -7) << "clockwise around a face of area 4, seen from outside";
  }
}

TEST(BoundaryLoops, KeepTheNodesOfACube) {
  const auto surface = testing::CreasedSurfaceOf(testing::Cube(5));
  for (const double g : {0.3, 1e3}) {
    for (const OrientedLoop& loop : LoopsOf(*surface, Uniform(g))) {
      int corners = 0;
      for (const SourcePoint& p : loop.points) corners += std::abs(p.position.x * p.position.y * p.position.z) == 1;
      EXPECT_EQ(corners, 4);
      EXPECT_THAT(loop.points, SizeIs(g == 1e3 ? 4 : 28)) << "a side of 2 has 7 edges of 0.29";
    }
  }
}

TEST(BoundaryLoops, DivideTwoCurvesBetweenTheSameNodes) {
  // In an ample field both would be the edge between the two nodes.
  const auto surface = testing::CreasedSurfaceOf(testing::HalfDiskPrism());
  const auto loops = LoopsOf(*surface, Uniform(1e3));
  const std::set<JointEdge> edges = CreaseEdges(loops);
  EXPECT_THAT(edges, SizeIs(2 * (2 * 4 + 2 * 2 + 2))) << "two for each diameter, four for each arc, one up each side";
}

TEST(BoundaryLoops, DivideACurveFromANodeToItselfIntoThree) {
  const auto surface = testing::CreasedSurfaceOf(testing::DropPrism());
  const std::set<JointEdge> edges = CreaseEdges(LoopsOf(*surface, Uniform(1e3)));
  EXPECT_GE(edges.size(), 2 * (2 * 3 + 1u));
}

TEST(BoundaryLoops, DivideTheCreasesAroundTwoPatchesThatWouldBeTheSameTriangle) {
  const auto surface = testing::CreasedSurfaceOf(testing::Pillow());
  const auto loops = LoopsOf(*surface, Uniform(1e3));
  ASSERT_THAT(loops, SizeIs(2));
  for (const OrientedLoop& loop : loops) EXPECT_GT(loop.points.size(), 3u);
}

TEST(BoundaryLoops, JoinRimsWhereACreaseEndsOnThem) {
  const auto surface = testing::CreasedSurfaceOf(testing::Roof(10));
  const auto loops = LoopsOf(*surface, Uniform(0.3));
  ASSERT_THAT(loops, SizeIs(2));
  for (const OrientedLoop& loop : loops) {
    const size_t n = loop.points.size();
    ASSERT_THAT(loop.joints, SizeIs(n));
    for (size_t i = 0; i < n; ++i) {
      const bool on_fold = loop.points[i].position.y == 0, to_fold = loop.points[(i + 1) % n].position.y == 0;
      EXPECT_EQ(loop.joints[i] != kNoJoint, on_fold);
      EXPECT_EQ(loop.creases[i], on_fold && to_fold);
    }
  }
}

TEST(BoundaryLoops, AreWithoutJointsWhereThereAreNoCreases) {
  for (const OrientedLoop& loop : LoopsOf(*testing::CreasedSurfaceOf(testing::DiskWithHoles(40, 2)), Uniform(0.1))) {
    EXPECT_THAT(loop.joints, IsEmpty());
    EXPECT_THAT(loop.creases, IsEmpty());
  }
}

TEST(BoundarySizing, DoesNotShortenEdgesAroundASmallPatch) {
  // A rim is at least about five edges long, a patch's is as long as its curves ask for.
  const auto surface = testing::CreasedSurfaceOf(testing::Cube(5));
  auto samples = BoundarySizingSamples(*surface, [](double) { return std::numeric_limits<double>::infinity(); }, {});
  ASSERT_TRUE(samples.ok());
  for (const SizingSample& s : *samples) EXPECT_GT(s.ideal_length, 1e6);
}

TEST(BoundaryLoops, StopWhenTheContextSaysSo) {
  const std::atomic<bool> stop = true;
  Context context;
  context.stop = &stop;
  const auto surface = SurfaceOf(testing::Sheet(5));
  EXPECT_EQ(BoundaryLoops(*surface, Uniform(0.1), {kAnySagitta}, context).status().code(),
            absl::StatusCode::kCancelled);
}

// Three round holes in a disk, in a field so coarse that each gets a triangle.
TEST(BoundaryLoops, KeepTheSagittaThatIsAskedFor) {
  const auto surface = SurfaceOf(testing::DiskWithHoles(60));
  const auto points = [&](const SagittaLimits& limits) {
    const auto loops = BoundaryLoops(*surface, Uniform(0.5), limits, {});
    size_t count = 0;
    for (const OrientedLoop& loop : *loops) count += loop.points.size();
    return count;
  };
  EXPECT_GT(points({0.005}), points({}) + 8);
  EXPECT_EQ(points({.rim = 0.005}), points({0.005}));
}

}  // namespace
}  // namespace meshfront
