#include "core/surface/mesh_surface.h"

#include <cmath>
#include <limits>

#include "core/surface/vertex_normals.h"
#include "tests/core/surface/surfaces.h"
#include "tests/support/matchers.h"
#include "tests/support/shapes.h"

namespace meshfront {
namespace {

using testing::StatusIs;
using testing::SurfaceOf;

// The point of the surface closest to p, from the vertex closest to p.
SourcePoint Near(const MeshSurface& surface, const Vec3& p) {
  uint32_t best = 0;
  const TriangleMesh& mesh = surface.mesh();
  for (uint32_t v = 1; v < mesh.positions.size(); ++v) {
    if (Distance(mesh.positions[v], p) < Distance(mesh.positions[best], p)) best = v;
  }
  return surface.Snap(surface.AtVertex(VertexId(best)), p);
}

TEST(MeshSurface, RefusesWhatIsNoOrientedManifold) {
  TriangleMesh flipped = testing::Icosphere(1);
  std::swap(flipped.triangles[3][0], flipped.triangles[3][1]);
  EXPECT_THAT(MeshSurface::Create(flipped, Context{}), StatusIs(absl::StatusCode::kInvalidArgument, "manifold"));
  EXPECT_THAT(MeshSurface::Create({}, Context{}), StatusIs(absl::StatusCode::kInvalidArgument, "no triangles"));
}

TEST(MeshSurface, NamesTheOffendingVertex) {
  TriangleMesh mesh = testing::Icosphere(1);
  mesh.positions[7].y = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(MeshSurface::Create(mesh, Context{}), StatusIs(absl::StatusCode::kInvalidArgument, "vertex 7"));
  mesh = testing::Icosphere(1);
  mesh.triangles[5][1] = VertexId(99999);
  EXPECT_THAT(MeshSurface::Create(mesh, Context{}), StatusIs(absl::StatusCode::kInvalidArgument, "triangle 5"));
}

TEST(MeshSurface, RefusesSizesThatOverflow) {
  EXPECT_THAT(MeshSurface::Create(testing::Scaled(testing::Icosphere(1), 1e100), Context{}),
              StatusIs(absl::StatusCode::kInvalidArgument, "diagonal"));
}

TEST(MeshSurface, PointsItsNormalsOutwards) {
  const auto surface = SurfaceOf(testing::UvSphere(40, 9));
  for (size_t v = 0; v < surface->mesh().positions.size(); ++v) {
    EXPECT_GT(Dot(surface->vertex_normals()[v], Normalized(surface->mesh().positions[v])), 0.99);
  }
}

TEST(ApproximateAngle, IsWithinItsBound) {
  for (double angle = 0; angle <= 3.1416; angle += 0.01) EXPECT_NEAR(ApproximateAngle(std::cos(angle)), angle, 7e-5);
}

TEST(MeshSurface, SeedsEveryClosedComponentOnce) {
  const auto surface = SurfaceOf(testing::Joined(testing::TwoSpheres(3), testing::Moved(testing::Sheet(6), {0, 0, 9})));
  EXPECT_EQ(surface->component_count(), 3u);
  const auto seeds = surface->Seeds();
  ASSERT_EQ(seeds.size(), 2u);
  EXPECT_NE(surface->ComponentOf(FaceId(seeds[0].patch)), surface->ComponentOf(FaceId(seeds[1].patch)));
  EXPECT_EQ(surface->Seeds(true).size(), 3u);
}

TEST(MeshSurface, SeedsAwayFromSharpPlaces) {
  const auto surface = SurfaceOf(testing::Cube(12));
  const Vec3 p = surface->Seeds()[0].position;
  EXPECT_NEAR(std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}), 1, 1e-9);
  int far_from_edge = 0;
  for (const double c : {p.x, p.y, p.z}) far_from_edge += std::abs(c) < 0.7;
  EXPECT_EQ(far_from_edge, 2);
}

TEST(MeshSurface, KnowsItsRim) {
  const auto surface = SurfaceOf(testing::Sheet(4));
  int rim = 0;
  for (uint32_t v = 0; v < surface->mesh().positions.size(); ++v) {
    const SourcePoint p = surface->AtVertex(VertexId(v));
    const bool on_rim = std::max(std::abs(p.position.x), std::abs(p.position.y)) == 1;
    EXPECT_EQ(surface->IsOnBoundary(p), on_rim);
    rim += on_rim;
  }
  EXPECT_EQ(rim, 16);
  EXPECT_TRUE(surface->IsOnBoundary(surface->Snap(surface->AtVertex(VertexId(12)), {5, 0.1, 0})));
  EXPECT_FALSE(surface->IsOnBoundary(surface->AtFace(FaceId(0), 0.3, 0.3)));
}

TEST(MeshSurface, FindsNoApexBeyondTheRim) {
  // A front edge along x = 0.9 with the open side towards the rim at x = 1.
  const auto surface = SurfaceOf(testing::Sheet(8));
  const SourcePoint a = Near(*surface, {0.9, 0, 0}), b = Near(*surface, {0.9, 0.2, 0});
  EXPECT_EQ(surface->FindApex(a, b, 0.2, 0.2), std::nullopt);
  const auto apex = surface->FindApex(b, a, 0.2, 0.2);
  ASSERT_TRUE(apex.has_value());
  EXPECT_NEAR(apex->position.x, 0.9 - std::sqrt(0.03), 1e-12);
}

TEST(MeshSurface, NeverJumpsToTheOtherSideOfAThinSlab) {
  // Edges ten times as long as the slab is thick, everywhere on its upper side.
  const auto surface = SurfaceOf(testing::ThinSlab(60, 0.02));
  for (double x = -0.75; x <= 0.75; x += 0.1) {
    const SourcePoint a = Near(*surface, {x, 0.1, 0.01}), b = Near(*surface, {x, 0.3, 0.01});
    ASSERT_GT(a.normal.z, 0.9);
    for (const double radius : {0.15, 0.2, 0.25}) {
      const auto apex = surface->FindApex(a, b, radius, radius);
      if (!apex) continue;
      EXPECT_GT(apex->position.z, 0);
      EXPECT_GT(apex->normal.z, 0);
    }
    EXPECT_GT(surface->Snap(a, {x, 0.1, -0.02}).position.z, 0);
  }
}

TEST(MeshSurface, FindsNoApexOnTheOtherSideWhereASlabEnds) {
  // The open side of the edge ends 0.02 away; the circle comes down on no part of the upper side.
  const auto surface = SurfaceOf(testing::ThinSlab(60, 0.02));
  const SourcePoint a = Near(*surface, {0.96, 0, 0.01}), b = Near(*surface, {0.96, 0.2, 0.01});
  const auto apex = surface->FindApex(a, b, 0.2, 0.2);
  EXPECT_GE(apex.value_or(a).normal.z, 0);
}

TEST(MeshSurface, StaysOnItsTubeNextToAnother) {
  // Two tubes along z whose gap is 1 % of the radius; edges run along the lines that face each other.
  const auto surface = SurfaceOf(testing::ParallelTubes(0.01));
  const Box3 box = BoundingBox(surface->mesh());
  const double middle = 0.5 * (box.min.x + box.max.x);
  for (const double side : {-1.0, 1.0}) {
    const SourcePoint a = Near(*surface, {middle + side * 0.01, 0, 0}),
                      b = Near(*surface, {middle + side * 0.01, 0, 0.3});
    const auto component = surface->ComponentOf(FaceId(a.patch));
    for (const auto& [from, to] : {std::pair(a, b), std::pair(b, a)}) {
      const auto apex = surface->FindApex(from, to, 0.3, 0.3);
      ASSERT_TRUE(apex.has_value());
      EXPECT_EQ(surface->ComponentOf(FaceId(apex->patch)), component);
      EXPECT_GT(side * (apex->position.x - middle), 0);
    }
  }
}

TEST(MeshSurface, PlacesAroundASharpEdge) {
  // A cube's edge between the front and the apex: the walk turns over it.
  const auto surface = SurfaceOf(testing::Cube(10));
  const SourcePoint a = Near(*surface, {0.95, 0, 1}), b = Near(*surface, {0.95, 0.2, 1});
  const auto apex = surface->FindApex(a, b, 0.2, 0.2);
  ASSERT_TRUE(apex.has_value());
  EXPECT_NEAR(apex->position.x, 1, 1e-9);
  EXPECT_LT(apex->position.z, 1);
}

TEST(MeshSurface, SurvivesSourcePointsFromElsewhere) {
  const auto surface = SurfaceOf(testing::Icosphere(2));
  const SourcePoint nowhere{{0, 0, 2}, {0, 0, 1}};
  EXPECT_EQ(surface->FindApex(nowhere, nowhere, 1, 1), std::nullopt);
  EXPECT_NEAR(Norm(surface->Snap(nowhere, {0, 0, 3}).position), 1, 0.05);
  SourcePoint nan = surface->AtVertex(VertexId(0));
  nan.position.x = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(surface->FindApex(nan, surface->AtVertex(VertexId(1)), 0.1, 0.1), std::nullopt);
  (void)surface->Snap(nan, nan.position);
}

TEST(MeshSurface, InterpolatesTheCurvature) {
  const auto surface = SurfaceOf(testing::Icosphere(4, 2));
  EXPECT_NEAR(surface->MaxCurvatureAt(surface->AtFace(FaceId(17), 0.2, 0.5)), 0.5, 0.02);
}

// A sheet with a pimple a millionth of its side wide: nobody sees it, and edges as short would be most of the mesh.
TEST(MeshSurface, TakesATurnThatNobodySeesOverAVisibleLength) {
  constexpr double kShrink = 1e-5, kRadius = 4e-6;
  const auto surface = SurfaceOf(testing::Mapped(testing::Sheet(40), [](const Vec3& p) {
    if (std::hypot(p.x, p.y) > 0.25) return p;
    const double x = kShrink * p.x, y = kShrink * p.y;
    return Vec3{x, y, kRadius - std::sqrt(kRadius * kRadius - x * x - y * y)};
  }));
  double largest = 0;
  for (const double curvature : surface->vertex_curvatures()) largest = std::max(largest, curvature);
  EXPECT_GT(largest, 100) << "but it does turn";
  EXPECT_LT(largest, 2.1 / (2e-4 * std::sqrt(8.0)));
}

}  // namespace
}  // namespace meshfront
