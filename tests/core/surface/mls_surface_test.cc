// The original moving-least-squares surface of samples of shapes that are known.
#include "core/surface/mls_surface.h"

#include <cmath>
#include <memory>

#include "gtest/gtest.h"
#include "tests/support/point_surface_derivatives.h"
#include "tests/support/shapes.h"

namespace meshfront {
namespace {

std::unique_ptr<MlsSurface> SurfaceOf(const TriangleMesh& points, double radius = 4) {
  auto samples = MlsSamples::Create(points.positions, points.normals, radius, Context{});
  EXPECT_TRUE(samples.ok()) << samples.status();
  return std::make_unique<MlsSurface>(*std::move(samples));
}

TriangleMesh SpherePoints(int subdivisions) {
  TriangleMesh points = testing::Icosphere(subdivisions);
  points.normals = points.positions;
  return points;
}

// Against finite differences of the fit itself.
TEST(MlsSurface, HasTheDerivativesOfItsDistance) {
  const auto surface = SurfaceOf(testing::Sampled(testing::Torus(1, 0.4, 100, 40), 4000));
  testing::ExpectDerivativesOfValue(*surface, {.step = 1e-5, .height = 0.1, .gradient = 1e-4, .curvature = 1e-2});
}

TEST(MlsSurface, LiesOnTheSphereThatWasSampled) {
  const auto surface = SurfaceOf(SpherePoints(5));
  for (uint32_t i = 0; i < 10242; i += 197) {
    const SourcePoint p = surface->AtSample(i);
    EXPECT_NEAR(Norm(p.position), 1, 2e-5);
    EXPECT_GE(Dot(p.normal, Normalized(p.position)), 0.99999);
    EXPECT_NEAR(surface->MaxCurvatureAt(p), 1, 0.02);
  }
}

// A plane through points on a quadric is off by as much as it bends; the polynomial follows.
TEST(MlsSurface, FollowsAQuadric) {
  const auto height = [](double x, double y) { return 0.4 * x * x - 0.25 * y * y + 0.1 * x * y; };
  TriangleMesh points = testing::Sampled(testing::HeightField(60, height), 6000);
  for (Vec3& x : points.positions) x.z = height(x.x, x.y);
  const auto surface = SurfaceOf(points);
  for (uint32_t i = 0; i < 6000; i += 37) {
    const MlsSample& s = surface->samples().samples()[i];
    if (std::max(std::abs(s.position.x), std::abs(s.position.y)) > 0.7) continue;
    const Vec3 p = surface->Snap(surface->AtSample(i), s.position + 0.01 * s.normal).position;
    EXPECT_NEAR(p.z, height(p.x, p.y), 3e-5);
  }
}

TEST(MlsSurface, DoesNotSeeTheOtherSideOfAThinPlate) {
  const double thickness = 0.04;
  const auto surface = SurfaceOf(testing::Sampled(testing::ThinSlab(60, thickness), 6000));
  for (uint32_t i = 0; i < 6000; i += 7) {
    const MlsSample& s = surface->samples().samples()[i];
    if (std::max(std::abs(s.position.x), std::abs(s.position.y)) > 0.8 || std::abs(s.normal.z) < 0.99) continue;
    const SourcePoint p = surface->AtSample(i);
    EXPECT_NEAR(p.position.z, std::copysign(thickness / 2, s.normal.z), 1e-4);
  }
}

// Five points around each place of a sphere are no polynomial: there it is the implicit surface.
TEST(MlsSurface, IsTheImplicitSurfaceWhereSamplesAreTooFew) {
  const auto surface = SurfaceOf(SpherePoints(3), 1.3);
  auto samples = MlsSamples::Create(SpherePoints(3).positions, SpherePoints(3).normals, 1.3, Context{});
  const ImplicitMlsSurface implicit(*std::move(samples));
  for (uint32_t i = 0; i < 642; i += 17)
    EXPECT_LE(Distance(surface->AtSample(i).position, implicit.AtSample(i).position), 1e-6);
}

}  // namespace
}  // namespace meshfront
