// What every Surface promises (core/surface/surface.h), for each kind of surface. A new kind is a Subject, and one line at the end.
#include <cmath>
#include <functional>
#include <memory>
#include <random>
#include <string>

#include "core/geometry/triangle.h"
#include "core/surface/implicit_mls_surface.h"
#include "core/surface/mesh_surface.h"
#include "core/surface/mls_surface.h"
#include "tests/core/surface/surfaces.h"
#include "tests/support/formula_surface.h"
#include "tests/support/shapes.h"

namespace meshfront {
namespace {

using testing::SurfaceOf;

// A surface under test, places on it to start from, and how far a place is from it on the side of another one.
struct Subject {
  std::shared_ptr<Surface> surface;
  std::function<SourcePoint(std::mt19937&)> random_point;
  std::function<SourcePoint(const SourcePoint&)> beside;  // a place close to one
  std::function<double(const Vec3&, const SourcePoint&)> distance;
};

struct Case {
  std::string name;
  std::function<Subject()> make;
  double edge;                 // a front edge's length there
  double local_minima = 1e-9;  // how much farther than the closest a locally closest point may be, in edges
  double off = 1e-8;           // how far from the surface a place on it may lie, in edges
  double rounding = 1e-12;     // how far from itself such a place may snap to, in edges
};
void PrintTo(const Case& c, std::ostream* os) { *os << c.name; }

double DistanceToMesh(const TriangleMesh& mesh, const Vec3& p) {
  double nearest = INFINITY;
  for (const Triangle& t : mesh.triangles) {
    const TrianglePoint closest =
        ClosestPointOnTriangle(p, mesh.PositionAt(t[0]), mesh.PositionAt(t[1]), mesh.PositionAt(t[2]));
    nearest = std::min(nearest, Distance(p, closest.position));
  }
  return nearest;
}

SourcePoint RandomPlaceOn(const MeshSurface& surface, std::mt19937& random) {
  std::uniform_int_distribution<uint32_t> face(0, static_cast<uint32_t>(surface.mesh().triangles.size() - 1));
  std::uniform_real_distribution<double> unit(0, 1);
  double u = unit(random), v = unit(random);
  if (u + v > 1) u = 1 - u, v = 1 - v;
  return surface.AtFace(FaceId(face(random)), u, v);
}

std::function<Subject()> Mesh(std::function<TriangleMesh()> shape) {
  return [shape] {
    const std::shared_ptr<MeshSurface> surface = SurfaceOf(shape());
    return Subject{surface, [surface](std::mt19937& random) { return RandomPlaceOn(*surface, random); },
                   [surface](const SourcePoint& p) { return surface->AtFace(FaceId(p.patch), 0.2, 0.7); },
                   [surface](const Vec3& x, const SourcePoint&) { return DistanceToMesh(surface->mesh(), x); }};
  };
}

SourcePoint SnappedBeside(const Surface& surface, const SourcePoint& p, double distance) {
  return surface.Snap(p, p.position + distance * Normalized(Cross(p.normal, Vec3{0.3, 0.5, 0.8})));
}

// By the function's value and slope.
double HeightOver(const PointSurface& surface, const Vec3& x, const SourcePoint& like) {
  const MlsValue<1> value = surface.ValueAt(x, surface.samples().PatchNear(x, like.normal, like.patch));
  return std::abs(value.f.value()) / Norm(value.f.Gradient());
}

// Evenly sampled: vertices of a fine mesh, or places at random on a coarse one.
template <typename Kind>
std::function<Subject()> Points(std::function<TriangleMesh()> points, double edge) {
  return [points, edge] {
    const TriangleMesh sampled = points();
    auto samples = MlsSamples::Create(sampled.positions, sampled.normals, 4, Context{});
    EXPECT_TRUE(samples.ok()) << samples.status();
    const auto surface = std::make_shared<Kind>(*std::move(samples));
    const auto at_random = [surface](std::mt19937& random) {
      const auto count = static_cast<uint32_t>(surface->samples().samples().size());
      return surface->AtSample(std::uniform_int_distribution<uint32_t>(0, count - 1)(random));
    };
    return Subject{surface, at_random,
                   [surface, edge](const SourcePoint& p) { return SnappedBeside(*surface, p, 0.1 * edge); },
                   [surface](const Vec3& x, const SourcePoint& like) { return HeightOver(*surface, x, like); }};
  };
}

std::function<Subject()> Formula(testing::FormulaSurface::Formula formula, double edge) {
  return [formula, edge] {
    const auto surface = std::make_shared<testing::FormulaSurface>(formula);
    const auto at_random = [surface](std::mt19937& random) {
      std::uniform_real_distribution<double> unit(-1, 1);
      return surface->Snap({}, {1.5 * unit(random), unit(random), 0.3 + 0.1 * unit(random)});
    };
    return Subject{surface, at_random,
                   [surface, edge](const SourcePoint& p) { return SnappedBeside(*surface, p, 0.1 * edge); },
                   [surface](const Vec3& x, const SourcePoint&) { return Distance(surface->Snap({}, x).position, x); }};
  };
}

std::vector<Case> Meshes() {
  return {
      {"Sphere", Mesh([] { return testing::Icosphere(4); }), 0.2},
      {"UvSphereWithSlivers", Mesh([] { return testing::UvSphere(60, 20); }), 0.2},
      {"Torus", Mesh([] { return testing::Torus(1, 0.4, 60, 24); }), 0.15},
      {"TorusCoarserThanTheEdges", Mesh([] { return testing::Torus(1, 0.4, 60, 24); }), 0.04},
      {"GenusThree", Mesh([] { return testing::GenusThree(64); }), 0.15},
      {"ThinSlab", Mesh([] { return testing::ThinSlab(); }), 0.02},
      {"ParallelTubes", Mesh([] { return testing::ParallelTubes(); }), 0.2},
      {"Terrain", Mesh([] { return testing::WavyTerrain(40); }), 0.1},
      {"FarFromTheOrigin", Mesh([] {
         return testing::Moved(testing::Icosphere(4), {1000, 2000, -500});
       }),
       0.2},
      {"Tiny", Mesh([] { return testing::Scaled(testing::Icosphere(4), 1e-9); }), 0.2e-9},
      {"Noisy", Mesh([] { return testing::WithNoise(testing::Icosphere(4), 0.004, 7); }), 0.2, 1e-3},
  };
}

// Surfaces of samples, whose iterations end at a small part of a support, and whose feet at a percent of the distance.
template <typename Kind>
std::vector<Case> PointSets() {
  const auto sphere = [] {
    TriangleMesh points = testing::Icosphere(4);
    points.normals = points.positions;
    return points;
  };
  const auto torus = [] { return testing::Sampled(testing::Torus(1, 0.4, 60, 24), 6000); };
  const auto far = [sphere] {
    TriangleMesh points = sphere();
    for (Vec3& x : points.positions) x += {1000, 2000, -500};
    return points;
  };
  const auto tiny = [sphere] {
    TriangleMesh points = sphere();
    for (Vec3& x : points.positions) x *= 1e-9;
    return points;
  };
  const auto slab = [] { return testing::Sampled(testing::ThinSlab(40, 0.1), 8000); };
  const auto terrain = [] { return testing::Sampled(testing::WavyTerrain(40), 5000); };
  return {
      {"Sphere", Points<Kind>(sphere, 0.2), 0.2, 1e-3, 1e-6, 1e-5},
      {"Torus", Points<Kind>(torus, 0.15), 0.15, 1e-3, 1e-6, 1e-5},
      {"FarFromTheOrigin", Points<Kind>(far, 0.2), 0.2, 1e-3, 1e-6, 1e-5},
      {"Tiny", Points<Kind>(tiny, 0.2e-9), 0.2e-9, 1e-3, 1e-6, 1e-5},
      {"ThinSlab", Points<Kind>(slab, 0.15), 0.15, 1e-3, 1e-6, 1e-5},
      {"Terrain", Points<Kind>(terrain, 0.1), 0.1, 1e-3, 1e-6, 1e-5},
  };
}

std::vector<Case> Formulas() {
  return {{"Torus", Formula(testing::TorusFormula, 0.15), 0.15, 1e-6, 1e-8, 1e-10},
          {"Blend", Formula(testing::BlendFormula, 0.15), 0.15, 1e-6, 1e-8, 1e-10}};
}

class SurfaceContract : public ::testing::TestWithParam<Case> {
 protected:
  void SetUp() override {
    subject_ = GetParam().make();
    surface_ = subject_.surface.get();
  }

  SourcePoint RandomPoint() { return subject_.random_point(random_); }
  // A front edge that begins at a: b lies about `edge` away on the same sheet.
  SourcePoint EndOfEdge(const SourcePoint& a) {
    std::uniform_real_distribution<double> unit(-1, 1);
    Vec3 direction = Normalized(Vec3{unit(random_), unit(random_), unit(random_)});
    direction = Normalized(direction - Dot(direction, a.normal) * a.normal);
    return surface_->Snap(a, a.position + GetParam().edge * direction);
  }

  std::mt19937 random_{42};
  Subject subject_;
  const Surface* surface_ = nullptr;
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
    EXPECT_LE(subject_.distance(apex->position, *apex), GetParam().off * edge + 1e-14 * Norm(a.position));
    EXPECT_NEAR(Norm(apex->normal), 1, 1e-12);
    EXPECT_GT(Dot(apex->position - a.position, Cross(b.position - a.position, a.normal + b.normal)), 0);
    const Vec3 triangle = Normalized(AreaVector(b.position, a.position, apex->position));
    EXPECT_GE(Dot(triangle, Normalized(a.normal + b.normal)), 0.2 - 1e-9);
    EXPECT_GT(Dot(triangle, apex->normal), 0);
  }
  EXPECT_GE(found, 240);
}

// Meshes only.
class MeshSurfaceContract : public SurfaceContract {};

TEST_P(MeshSurfaceContract, DescribesTheApexByItsFaceAndWeights) {
  const auto& mesh = dynamic_cast<const MeshSurface&>(*surface_);
  for (int i = 0; i < 100; ++i) {
    const SourcePoint a = RandomPoint(), b = EndOfEdge(a);
    const auto apex = surface_->FindApex(a, b, GetParam().edge, GetParam().edge);
    if (!apex) continue;
    ASSERT_LT(apex->patch, mesh.mesh().triangles.size());
    EXPECT_GE(apex->u, 0);
    EXPECT_GE(apex->v, 0);
    EXPECT_LE(apex->u + apex->v, 1 + 1e-15);
    const SourcePoint again = mesh.AtFace(FaceId(apex->patch), apex->u, apex->v);
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
              subject_.distance(target, snapped) + GetParam().local_minima * edge + 1e-14 * Norm(target));
  }
}

TEST_P(SurfaceContract, SnapsAPointOfTheSurfaceToItself) {
  for (int i = 0; i < 60; ++i) {
    const SourcePoint p = RandomPoint();
    const SourcePoint snapped = surface_->Snap(p, p.position);
    EXPECT_LE(Distance(snapped.position, p.position), GetParam().rounding * GetParam().edge + 1e-15 * Norm(p.position));
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
    const SourcePoint beside = subject_.beside(p);
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

std::string NameOf(const ::testing::TestParamInfo<Case>& info) { return info.param.name; }

INSTANTIATE_TEST_SUITE_P(Mesh, SurfaceContract, ::testing::ValuesIn(Meshes()), NameOf);
INSTANTIATE_TEST_SUITE_P(Mesh, MeshSurfaceContract, ::testing::ValuesIn(Meshes()), NameOf);
INSTANTIATE_TEST_SUITE_P(ImplicitMls, SurfaceContract, ::testing::ValuesIn(PointSets<ImplicitMlsSurface>()), NameOf);
INSTANTIATE_TEST_SUITE_P(Mls, SurfaceContract, ::testing::ValuesIn(PointSets<MlsSurface>()), NameOf);
INSTANTIATE_TEST_SUITE_P(Formula, SurfaceContract, ::testing::ValuesIn(Formulas()), NameOf);

}  // namespace
}  // namespace meshfront
