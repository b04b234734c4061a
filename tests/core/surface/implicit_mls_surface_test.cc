// The implicit moving-least-squares surface of samples of shapes that are known.
#include "core/surface/implicit_mls_surface.h"

#include <cmath>
#include <memory>
#include <random>

#include "core/geometry/triangle.h"
#include "gtest/gtest.h"
#include "tests/support/point_surface_derivatives.h"
#include "tests/support/shapes.h"

namespace meshfront {
namespace {

std::unique_ptr<ImplicitMlsSurface> SurfaceOf(const TriangleMesh& points, double radius = 4) {
  auto samples = MlsSamples::Create(points.positions, points.normals, radius, Context{});
  EXPECT_TRUE(samples.ok()) << samples.status();
  auto surface = std::make_unique<ImplicitMlsSurface>(*std::move(samples));
  EXPECT_TRUE(surface->ComputeCurvature(Context{}).ok());
  return surface;
}

// 10,242 samples.
std::unique_ptr<ImplicitMlsSurface> Sphere() {
  TriangleMesh points = testing::Icosphere(5);
  points.normals = points.positions;
  return SurfaceOf(points);
}

// Radii 1 and 0.4.
Vec3 TorusNormal(const Vec3& x) {
  const Vec3 around = Normalized(Vec3{x.x, x.y, 0});
  return Normalized(x - around);
}
std::unique_ptr<ImplicitMlsSurface> Torus(int around = 200, int along = 80) {
  TriangleMesh points = testing::Torus(1, 0.4, around, along);
  for (const Vec3& x : points.positions) points.normals.push_back(TorusNormal(x));
  return SurfaceOf(points);
}

TEST(ImplicitMls, HasTheDerivativesOfItsValue) {
  testing::ExpectDerivativesOfValue(*Torus(100, 40),
                                    {.step = 1e-6, .height = 0.2, .gradient = 1e-6, .curvature = 1e-4});
}

// n(x)·(x − a(x)) alone is off by h² / 12 on a unit sphere, 1.6e-3 here.
TEST(ImplicitMls, LiesOnTheSphereThatWasSampled) {
  const auto surface = Sphere();
  for (uint32_t i = 0; i < 10242; i += 197) {
    const SourcePoint p = surface->AtSample(i);
    EXPECT_NEAR(Norm(p.position), 1, 5e-5);
    EXPECT_GE(Dot(p.normal, Normalized(p.position)), 0.9995);
    EXPECT_NEAR(surface->MaxCurvatureAt(p), 1, 0.03);
  }
}

TEST(ImplicitMls, BendsLikeTheTorusThatWasSampled) {
  const auto surface = Torus();
  for (uint32_t i = 0; i < 16000; i += 397) {
    const SourcePoint p = surface->AtSample(i);
    EXPECT_NEAR(surface->MaxCurvatureAt(p), 1 / 0.4, 0.1);
    const auto [low, high] = PrincipalCurvatures(surface->Evaluate<2>(p.position, p.patch).f);
    const Vec3 middle = Normalized(Vec3{p.position.x, p.position.y, 0});
    EXPECT_NEAR(low, Dot(p.normal, middle) / Norm(Vec3{p.position.x, p.position.y, 0}), 0.1);
    EXPECT_NEAR(high, 1 / 0.4, 0.1);
  }
}

TEST(ImplicitMls, PlacesTheApexAtBothDistancesOnTheOpenSide) {
  const auto surface = Torus();
  std::mt19937 random(3);
  const auto unit = [&] { return static_cast<double>(random()) / 4294967296.0; };
  int found = 0;
  for (uint32_t i = 0; i < 6000; i += 41) {
    const SourcePoint a = surface->AtSample(i);
    const Vec3 u = Normalized(Cross(a.normal, Vec3{unit(), unit(), unit()}));
    const SourcePoint b = surface->Snap(a, a.position + 0.15 * u);
    const double radius_a = 0.15 * (0.8 + 0.4 * unit()), radius_b = 0.15 * (0.8 + 0.4 * unit());
    const auto apex = surface->FindApex(a, b, radius_a, radius_b);
    if (!apex) continue;
    ++found;
    EXPECT_NEAR(Distance(apex->position, a.position), radius_a, 1e-10);
    EXPECT_NEAR(Distance(apex->position, b.position), radius_b, 1e-10);
    EXPECT_LE(Distance(surface->Snap(*apex, apex->position).position, apex->position), 1e-8);
    EXPECT_NEAR(Norm(apex->normal), 1, 1e-12);
    EXPECT_GT(Dot(apex->position - a.position, Cross(b.position - a.position, a.normal + b.normal)), 0);
    EXPECT_GT(Dot(AreaVector(b.position, a.position, apex->position), apex->normal), 0);
  }
  EXPECT_GE(found, 140);
  const SourcePoint a = surface->AtSample(0);
  EXPECT_EQ(surface->FindApex(a, a, 0.1, 0.1), std::nullopt);
}

TEST(ImplicitMls, SnapsToTheFootOfATarget) {
  const auto surface = Sphere();
  for (uint32_t i = 0; i < 6000; i += 211) {
    const SourcePoint p = surface->AtSample(i);
    for (const double off : {0.05, -0.05}) {
      const SourcePoint start = surface->Snap(p, p.position + Vec3{0.05, 0.02, -0.03});
      EXPECT_LE(Distance(surface->Snap(start, p.position + off * p.normal).position, p.position), 2e-3);
    }
    EXPECT_LE(Distance(surface->Snap(p, p.position).position, p.position), 1e-8);
  }
}

// The plate's other side is half a spacing below: without a say it is as if it were not there.
TEST(ImplicitMls, DoesNotSeeTheOtherSideOfAThinPlate) {
  const double thickness = 0.02;
  const auto surface = SurfaceOf(testing::Sampled(testing::ThinSlab(60, thickness), 6000));
  int seen = 0;
  for (uint32_t i = 0; i < 6000; ++i) {
    const MlsSample& s = surface->samples().samples()[i];
    if (std::max(std::abs(s.position.x), std::abs(s.position.y)) > 0.8 || std::abs(s.normal.z) < 0.99) continue;
    const SourcePoint p = surface->AtSample(i);
    EXPECT_NEAR(p.position.z, std::copysign(thickness / 2, s.normal.z), 1e-9);
    const SourcePoint across = surface->Snap(p, p.position - 0.8 * thickness * p.normal);
    EXPECT_NEAR(across.position.z, p.position.z, 1e-9);
    ++seen;
  }
  EXPECT_GE(seen, 2000);
}

// Of a wedge of 60° the sides' normals point apart, but both have a say at their common edge: the surface turns around
// it and does not go on beyond.
TEST(ImplicitMls, TurnsAroundASharpEdge) {
  const auto surface = SurfaceOf(testing::Sampled(testing::Wedge(1.05, 20), 30000));
  const uint32_t top = surface->samples().NearestLike({0.05, 0, 1}, {0, -1, 0});
  const Vec3 beyond = surface->Snap(surface->AtSample(top), {-0.1, 0, 1}).position;
  EXPECT_GT(beyond.x, -0.01);
}

TEST(MlsSamples, TellHowDenseTheyAre) {
  const auto surface = Sphere();
  double total = 0;
  for (const double area : surface->samples().areas()) total += area;
  EXPECT_NEAR(total, 4 * M_PI, 0.8);
  EXPECT_NEAR(surface->samples().SpacingAt(17), std::sqrt(4 * M_PI / 10242), 0.01);
}

TEST(MlsSamples, WidenSupportsAroundPlacesOrEverywhere) {
  const auto surface = Sphere();
  const MlsSamples& before = surface->samples();
  const Vec3 place{0, 0, 1};
  const auto near = before.Widened({&place, 1}, 1.5, 16, Context{}), all = before.Widened({}, 1.5, 16, Context{});
  const auto bounded = before.Widened({}, 9, 5, Context{});
  ASSERT_TRUE(near.ok() && all.ok() && bounded.ok());
  const auto support = [](const MlsSamples& samples, const Vec3& x) {
    return samples.samples()[samples.NearestLike(x, x)].support;
  };
  EXPECT_NEAR(support(**near, place), 1.5 * support(before, place), 0.01 * support(before, place));
  EXPECT_DOUBLE_EQ(support(**near, -place), support(before, -place));
  EXPECT_NEAR(support(**all, -place), 1.5 * support(before, -place), 1e-12);
  EXPECT_NEAR(support(**bounded, place), 5.0 / 4 * support(before, place), 1e-12);
  const uint32_t at = (*all)->NearestLike(place, place);
  EXPECT_NEAR((*all)->SpacingAt(at), support(before, place) / 4, 1e-12);
}

TEST(MlsSamples, CountPartsAndLeaveStraysOut) {
  TriangleMesh points = testing::Sampled(testing::TwoSpheres(3), 4000);
  for (int i = 0; i < 5; ++i) {
    points.positions.push_back({10 + 0.01 * i, 0, 0});
    points.normals.push_back({0, 0, 1});
  }
  const auto surface = SurfaceOf(points);
  EXPECT_EQ(surface->samples().component_count(), 2u);
  EXPECT_EQ(surface->samples().stray_count(), 5u);
  EXPECT_EQ(surface->Seeds().size(), 2u);
}

TEST(MlsSamples, RefuseWhatIsNotFinite) {
  const std::vector<Vec3> places = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {NAN, 0, 1}}, normals(4, Vec3{0, 0, 1});
  EXPECT_EQ(MlsSamples::Create(places, normals, 4, Context{}).status().code(), absl::StatusCode::kInvalidArgument);
  EXPECT_FALSE(MlsSamples::Create(normals, {}, 4, Context{}).ok());
}

TEST(MlsSamples, AreTheSameAtAnyNumberOfThreads) {
  const TriangleMesh points = testing::Sampled(testing::Torus(1, 0.4, 60, 24), 5000);
  Context many;
  many.threads = 4;
  const auto one = MlsSamples::Create(points.positions, points.normals, 4, Context{}, 12, MlsWeights::kNarrowAtEdges);
  const auto four = MlsSamples::Create(points.positions, points.normals, 4, many);
  for (uint32_t p = 0; p < (*one)->patch_count(); ++p) EXPECT_EQ((*one)->ListOf(p), (*four)->ListOf(p));
}

TriangleMesh Roof() {
  return testing::Sampled(testing::HeightField(8, [](double x, double) { return -std::abs(x); }), 4000);
}

std::unique_ptr<MlsSamples> SamplesNarrowAtEdges(const TriangleMesh& points) {
  auto samples = MlsSamples::Create(points.positions, points.normals, 4, Context{}, 12, MlsWeights::kNarrowAtEdges);
  EXPECT_TRUE(samples.ok());
  return *std::move(samples);
}

// The ridge of a roof: where weights are narrow, the planes of the samples have more of a say too; with weights as wide as the supports, the
// surface rounds it more than twice as much.
TEST(ImplicitMls, StaysNearASharpEdge) {
  const TriangleMesh points = Roof();
  auto samples = SamplesNarrowAtEdges(points);
  auto widened = samples->Widened({}, 1.0001, 16, Context{});
  ASSERT_TRUE(widened.ok());
  const ImplicitMlsSurface narrow(std::move(samples)), wide(*std::move(widened));
  const auto rounding = [](const ImplicitMlsSurface& surface) {
    double sum = 0;
    for (double y = -0.6; y <= 0.6; y += 0.05) {
      const uint32_t nearest = surface.samples().NearestLike({0, y, 0}, {0, 0, 1});
      sum += Distance(surface.Snap(surface.AtSample(nearest), {0, y, 0}).position, {0, y, 0});
    }
    return sum;
  };
  EXPECT_LT(rounding(narrow), 0.45 * rounding(wide));
}

// Sizes follow the bend that supports see, however narrow weights are.
TEST(ImplicitMls, BendsAsSupportsSeeIt) {
  const TriangleMesh points = Roof();
  auto samples = SamplesNarrowAtEdges(points);
  auto widened = samples->Widened({}, 1.0001, 16, Context{});
  ASSERT_TRUE(widened.ok());
  ImplicitMlsSurface narrow(std::move(samples)), wide(*std::move(widened));
  ASSERT_TRUE(narrow.ComputeCurvature(Context{}).ok());
  ASSERT_TRUE(wide.ComputeCurvature(Context{}).ok());
  for (size_t i = 0; i < points.positions.size(); ++i)
    EXPECT_NEAR(narrow.curvatures()[i], wide.curvatures()[i], 0.01 * wide.curvatures()[i] + 0.01);
}

}  // namespace
}  // namespace meshfront
