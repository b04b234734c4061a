// What every Surface promises (core/surface/surface.h), for each kind of surface. A new kind is one line in Surfaces().
#include <cmath>
#include <functional>
#include <memory>
#include <random>
#include <string>

#include "core/geometry/triangle.h"
#include "core/surface/mesh_surface.h"
#include "tests/core/surface/surfaces.h"
#include "tests/support/shapes.h"

namespace meshfront {
namespace {

using testing::SurfaceOf;

// A surface under test with places on it to start from.
struct Case {
  std::string name;
  std::function<TriangleMesh()> mesh;
  double edge;                 // a front edge's length there
  double local_minima = 1e-9;  // how much farther than the closest a locally closest point may be, in edges
};
void PrintTo(const Case& c, std::ostream* os) { *os << c.name; }

std::vector<Case> Shapes() {
  return {
      {"Sphere", [] { return testing::Icosphere(4); }, 0.2},
      {"UvSphereWithSlivers", [] { return testing::UvSphere(60, 20); }, 0.2},
      {"Torus", [] { return testing::Torus(1, 0.4, 60, 24); }, 0.15},
      {"TorusCoarserThanTheEdges", [] { return testing::Torus(1, 0.4, 60, 24); }, 0.04},
      {"GenusThree", [] { return testing::GenusThree(64); }, 0.15},
      {"ThinSlab", [] { return testing::ThinSlab(); }, 0.02},
      {"ParallelTubes", [] { return testing::ParallelTubes(); }, 0.2},
      {"Terrain", [] { return testing::WavyTerrain(40); }, 0.1},
      {"FarFromTheOrigin",
       [] {
         return testing::Moved(testing::Icosphere(4), {1000, 2000, -500});
       },
       0.2},
      {"Tiny", [] { return testing::Scaled(testing::Icosphere(4), 1e-9); }, 0.2e-9},
      {"Noisy", [] { return testing::WithNoise(testing::Icosphere(4), 0.004, 7); }, 0.2, 1e-3},
  };
}

class SurfaceContract : public ::testing::TestWithParam<Case> {
 protected:
  void SetUp() override { surface_ = SurfaceOf(GetParam().mesh()); }

  SourcePoint RandomPoint() {
    std::uniform_int_distribution<uint32_t> face(0, static_cast<uint32_t>(surface_->mesh().triangles.size() - 1));
    std::uniform_real_distribution<double> unit(0, 1);
    double u = unit(random_), v = unit(random_);
    if (u + v > 1) u = 1 - u, v = 1 - v;
    return surface_->AtFace(FaceId(face(random_)), u, v);
  }
  // A front edge that begins at a: b lies about `edge` away on the same sheet.
  SourcePoint EndOfEdge(const SourcePoint& a) {
    std::uniform_real_distribution<double> unit(-1, 1);
    Vec3 direction = Normalized(Vec3{unit(random_), unit(random_), unit(random_)});
    direction = Normalized(direction - Dot(direction, a.normal) * a.normal);
    return surface_->Snap(a, a.position + GetParam().edge * direction);
  }
  double DistanceToMesh(const Vec3& p) const {
    double nearest = INFINITY;
    const TriangleMesh& mesh = surface_->mesh();
    for (const Triangle& t : mesh.triangles) {
      const TrianglePoint closest =
          ClosestPointOnTriangle(p, mesh.PositionAt(t[0]), mesh.PositionAt(t[1]), mesh.PositionAt(t[2]));
      nearest = std::min(nearest, Distance(p, closest.position));
    }
    return nearest;
  }

  std::mt19937 random_{42};
  std::unique_ptr<MeshSurface> surface_;
};

TEST_P(SurfaceContract, PlacesTheApexAtBothDistancesOnTheSurfaceOnTheOpenSide) {
  const double edge = GetParam().edge;
  std::uniform_real_distribution<double> factor(0.8, 1.25);
  int found = 0;
  for (int i = 0; i < 300; ++i) {
    const SourcePoint a = RandomPoint(), b = EndOfEdge(a);
    if (Distance(a.position, b.position) < 0.5 * edge) continue;  // ran into the rim
    const double radius_a = edge * factor(random_), radius_b = edge * factor(random_);
    const auto apex = surface_->FindApex(a, b, radius_a, radius_b);
    if (!apex) continue;
    ++found;
    const double slack = 1e-9 * edge + 1e-15 * Norm(a.position);
    EXPECT_NEAR(Distance(apex->position, a.position), radius_a, slack);
    EXPECT_NEAR(Distance(apex->position, b.position), radius_b, slack);
    EXPECT_LE(DistanceToMesh(apex->position), 1e-8 * edge + 1e-14 * Norm(a.position));
    EXPECT_GT(Dot(apex->position - a.position, Cross(b.position - a.position, a.normal + b.normal)), 0);
    const Vec3 triangle = Normalized(AreaVector(b.position, a.position, apex->position));
    EXPECT_GE(Dot(triangle, Normalized(a.normal + b.normal)), 0.2 - 1e-9);
    EXPECT_GT(Dot(triangle, apex->normal), 0);
  }
  EXPECT_GE(found, 240);
}

TEST_P(SurfaceContract, DescribesTheApexByItsFaceAndWeights) {
  for (int i = 0; i < 100; ++i) {
    const SourcePoint a = RandomPoint(), b = EndOfEdge(a);
    const auto apex = surface_->FindApex(a, b, GetParam().edge, GetParam().edge);
    if (!apex) continue;
    ASSERT_LT(apex->patch, surface_->mesh().triangles.size());
    EXPECT_GE(apex->u, 0);
    EXPECT_GE(apex->v, 0);
    EXPECT_LE(apex->u + apex->v, 1 + 1e-15);
    EXPECT_NEAR(Norm(apex->normal), 1, 1e-12);
    const SourcePoint again = surface_->AtFace(FaceId(apex->patch), apex->u, apex->v);
    EXPECT_LE(Distance(again.position, apex->position), 1e-8 * GetParam().edge + 1e-14 * Norm(a.position));
  }
}

TEST_P(SurfaceContract, SnapsToTheClosestPointFromNearBy) {
  const double edge = GetParam().edge;
  for (int i = 0; i < 60; ++i) {
    const SourcePoint p = RandomPoint(), start = EndOfEdge(p);
    const Vec3 target = p.position + 0.02 * edge * p.normal;
    const SourcePoint snapped = surface_->Snap(start, target);
    EXPECT_LE(Distance(snapped.position, target),
              DistanceToMesh(target) + GetParam().local_minima * edge + 1e-14 * Norm(target));
  }
}

TEST_P(SurfaceContract, SnapsAPointOfTheSurfaceToItself) {
  for (int i = 0; i < 60; ++i) {
    const SourcePoint p = RandomPoint();
    const SourcePoint snapped = surface_->Snap(p, p.position);
    EXPECT_LE(Distance(snapped.position, p.position), 1e-12 * GetParam().edge + 1e-15 * Norm(p.position));
  }
}

TEST_P(SurfaceContract, FindsFeetWhereItSnapsTo) {
  for (int i = 0; i < 60; ++i) {
    const SourcePoint p = RandomPoint(), start = EndOfEdge(p);
    const Vec3 target = p.position + 0.1 * GetParam().edge * p.normal;
    const SourcePoint foot = surface_->Foot(start, target), snapped = surface_->Snap(start, target);
    EXPECT_EQ(foot.position, snapped.position);
    EXPECT_EQ(foot.patch, snapped.patch);
  }
}

// From on its own face and from elsewhere.
TEST_P(SurfaceContract, ReachesWhatItSnapsTo) {
  const double tolerance = 1e-3 * GetParam().edge;
  int reached = 0;
  for (int i = 0; i < 60; ++i) {
    const SourcePoint p = RandomPoint(), start = EndOfEdge(p);
    const SourcePoint beside = surface_->AtFace(FaceId(p.patch), 0.2, 0.7);
    for (const SourcePoint& from : {start, beside}) {
      const bool arrives = Distance(surface_->Snap(from, p.position).position, p.position) <= tolerance;
      EXPECT_EQ(surface_->Reaches(from, p, tolerance), arrives);
      reached += arrives;
    }
  }
  EXPECT_GE(reached, 60);
}

TEST_P(SurfaceContract, FindsNoApexWhereTheSpheresDoNotMeet) {
  const SourcePoint a = RandomPoint(), b = EndOfEdge(a);
  const double length = Distance(a.position, b.position);
  EXPECT_EQ(surface_->FindApex(a, b, 0.4 * length, 0.5 * length), std::nullopt);
  EXPECT_EQ(surface_->FindApex(a, b, 3 * length, 1.9 * length), std::nullopt);
  EXPECT_EQ(surface_->FindApex(a, a, length, length), std::nullopt);
}

TEST_P(SurfaceContract, GivesTheSameAnswerTwice) {
  for (int i = 0; i < 20; ++i) {
    const SourcePoint a = RandomPoint(), b = EndOfEdge(a);
    const auto first = surface_->FindApex(a, b, GetParam().edge, GetParam().edge);
    const auto second = surface_->FindApex(a, b, GetParam().edge, GetParam().edge);
    ASSERT_EQ(first.has_value(), second.has_value());
    EXPECT_EQ(first.value_or(a).position, second.value_or(a).position);
  }
}

TEST_P(SurfaceContract, TellsAFiniteCurvatureEverywhere) {
  for (int i = 0; i < 100; ++i) {
    const double curvature = surface_->MaxCurvatureAt(RandomPoint());
    EXPECT_TRUE(std::isfinite(curvature));
    EXPECT_GE(curvature, 0);
  }
}

INSTANTIATE_TEST_SUITE_P(Mesh, SurfaceContract, ::testing::ValuesIn(Shapes()),
                         [](const auto& info) { return info.param.name; });

}  // namespace
}  // namespace meshfront
