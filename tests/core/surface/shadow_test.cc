#include <cmath>

#include "core/surface/mesh_surface.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/core/surface/surfaces.h"
#include "tests/support/shapes.h"

namespace meshfront {
namespace {

using meshfront::testing::HeightField;
using meshfront::testing::Sheet;
using meshfront::testing::SurfaceOf;
using ::testing::IsEmpty;

struct Found {
  std::vector<FarPlace> far;
  std::vector<DoubtfulPart> doubtful;
  bool all = false;
};
Found FindFar(const MeshSurface& surface, const std::array<Vec3, 3>& triangle, double bound, double beside = 0.1) {
  SourcePoint start = surface.AtVertex(VertexId(0));
  for (int i = 0; i < 3; ++i) start = surface.Snap(start, triangle[0]);
  Found found;
  found.all = surface.FindFarPlaces(start, triangle, bound, beside, found.far, &found.doubtful);
  return found;
}

const std::array<Vec3, 3> kTriangle = {Vec3{-0.5, -0.43, 0}, Vec3{0.52, -0.4, 0}, Vec3{0.03, 0.47, 0}};

TEST(FarPlaces, AreNoneOverAFlatSheet) {
  const auto surface = SurfaceOf(Sheet(12));
  const Found found = FindFar(*surface, kTriangle, 1e-9);
  EXPECT_TRUE(found.all);
  EXPECT_THAT(found.far, IsEmpty());
}

// Who does not ask for the doubtful parts gets the same places.
TEST(FarPlaces, AreTheSameWithoutTheDoubtfulParts) {
  TriangleMesh mesh = Sheet(12);
  for (size_t k = 0; k < mesh.positions.size(); k += 5) mesh.positions[k].z = 0.05;
  const auto surface = SurfaceOf(mesh);
  const Found found = FindFar(*surface, kTriangle, 0.01);
  std::vector<FarPlace> far;
  const SourcePoint start = surface->Snap(surface->AtVertex(VertexId(0)), kTriangle[0]);
  EXPECT_EQ(surface->FindFarPlaces(start, kTriangle, 0.01, 0.1, far, nullptr), found.all);
  ASSERT_EQ(far.size(), found.far.size());
  EXPECT_FALSE(found.doubtful.empty());
  for (size_t i = 0; i < far.size(); ++i) EXPECT_EQ(far[i].below, found.far[i].below);
}

TEST(FarPlaces, AreEverywhereOverATriangleThatIsOff) {
  const auto surface = SurfaceOf(Sheet(12));
  auto triangle = kTriangle;
  for (Vec3& p : triangle) p.z = 0.1;
  EXPECT_THAT(FindFar(*surface, triangle, 0.1001).far, IsEmpty());
  const Found found = FindFar(*surface, triangle, 0.0999);
  EXPECT_TRUE(found.all);
  EXPECT_GT(found.far.size(), 20u);
  for (const FarPlace& p : found.far) {
    EXPECT_NEAR(p.below.z, 0.1, 1e-12);
    EXPECT_NEAR(p.above.position.z, 0, 1e-12);
    EXPECT_NEAR(Distance(p.below, p.above.position), 0.1, 1e-12) << "seen along the normal";
  }
}

// One vertex sticks out, wherever it is under the triangle.
TEST(FarPlaces, IncludeASingleVertexThatSticksOut) {
  for (int k = 0; k < 13 * 13; ++k) {
    TriangleMesh mesh = Sheet(12);
    Vec3& spike = mesh.positions[static_cast<size_t>(k)];
    spike.z = 0.05;
    const Vec3 tip = spike;
    const auto surface = SurfaceOf(std::move(mesh));
    const Vec3 d = tip - kTriangle[0], e1 = kTriangle[1] - kTriangle[0], e2 = kTriangle[2] - kTriangle[0];
    const double area = Cross(e1, e2).z, v = Cross(d, e2).z / area, w = Cross(e1, d).z / area;
    const double least = std::min({v, w, 1 - v - w});
    const Found found = FindFar(*surface, kTriangle, 0.04);
    const bool is_found = std::any_of(found.far.begin(), found.far.end(),
                                      [&](const FarPlace& p) { return p.is_detail && p.above.position == tip; });
    if (std::abs(least + 0.1) > 0.001) {
      EXPECT_EQ(is_found, least > -0.1) << tip.x << " " << tip.y;
    }
    for (const FarPlace& p : found.far) EXPECT_EQ(p.is_detail && p.is_beside, p.is_detail && least < 0);
  }
}

// What is said to be within the bound is, wherever one looks.
TEST(FarPlaces, AreThereWhereverTheTriangleIsFar) {
  const auto surface =
      SurfaceOf(HeightField(24, [](double x, double y) { return 0.05 * std::sin(9 * x + y) * std::cos(7 * y); }));
  int within = 0, beyond = 0;
  for (int k = 0; k < 200; ++k) {
    const double angle = k, size = 0.05 + 0.0015 * k;
    const Vec3 middle{0.4 * std::sin(0.7 * k), 0.4 * std::cos(1.3 * k), 0};
    std::array<Vec3, 3> triangle;
    SourcePoint at = surface->AtVertex(VertexId(312));
    for (int i = 0; i < 3; ++i) {
      const double turn = angle + 2.0944 * i;
      at = surface->Snap(at, middle + size * Vec3{std::cos(turn), std::sin(turn), 0});
      triangle[i] = at.position;
    }
    constexpr double kBound = 0.01;
    double farthest = 0;
    for (int i = 0; i <= 20; ++i) {
      for (int j = 0; i + j <= 20; ++j) {
        const Vec3 p = triangle[0] + i / 20.0 * (triangle[1] - triangle[0]) + j / 20.0 * (triangle[2] - triangle[0]);
        farthest = std::max(farthest, Distance(p, surface->Snap(at, p).position));
      }
    }
    const Found found = FindFar(*surface, triangle, kBound);
    EXPECT_TRUE(found.all);
    EXPECT_TRUE(!found.far.empty() || farthest <= kBound) << k << ": " << farthest;
    ++(found.far.empty() ? within : beyond);
  }
  EXPECT_GT(std::min(within, beyond), 20);
}

TEST(FarPlaces, AreNotAllKnownBeyondARim) {
  const auto surface = SurfaceOf(Sheet(12));
  auto triangle = kTriangle;
  for (Vec3& p : triangle) p.x += 1.2;
  EXPECT_FALSE(FindFar(*surface, triangle, 0.01).all);
}

// What is cut off by a rim is looked at more closely; the rest is known.
TEST(FarPlaces, LeaveInDoubtWhatLiesBeyondARim) {
  const auto surface = SurfaceOf(Sheet(12));
  const std::array<Vec3, 3> triangle = {Vec3{0.1, 0.03, 0}, Vec3{1.05, -0.4, 0}, Vec3{1.05, 0.4, 0}};
  const Found found = FindFar(*surface, triangle, 0.01);
  EXPECT_TRUE(found.all);
  EXPECT_THAT(found.far, IsEmpty());
  ASSERT_THAT(found.doubtful, ::testing::SizeIs(2));
  for (const DoubtfulPart& part : found.doubtful) {
    for (const Vec3& p : part.corners) EXPECT_GT(p.x, 1 - 1e-9);
  }
}

TEST(FarPlaces, LeaveNothingInDoubtBesideAStraightRim) {
  const auto surface = SurfaceOf(Sheet(12));
  const Found found = FindFar(*surface, {Vec3{0.1, 0.03, 0}, Vec3{1, -0.4, 0}, Vec3{1, 0.4, 0}}, 0.01);
  EXPECT_TRUE(found.all);
  EXPECT_THAT(found.doubtful, IsEmpty());
}

// Where nothing of a face but its inside lies over the triangle.
TEST(FarPlaces, LeaveInDoubtACornerThatIsFarFromTheFaceOverIt) {
  const auto surface = SurfaceOf(Sheet(1));
  const std::array<Vec3, 3> triangle = {Vec3{-0.6, -0.4, 0}, Vec3{-0.5, -0.4, 0}, Vec3{-0.5, -0.3, 0.03}};
  EXPECT_THAT(FindFar(*surface, triangle, 0.031).doubtful, IsEmpty());
  EXPECT_FALSE(FindFar(*surface, triangle, 0.02).doubtful.empty());
}

// From a face that does not lie over the triangle there is no way to those that do.
TEST(FarPlaces, AreNotKnownFromAFaceElsewhere) {
  const auto surface = SurfaceOf(Sheet(12));
  std::vector<FarPlace> far;
  std::vector<DoubtfulPart> doubtful;
  EXPECT_FALSE(surface->FindFarPlaces(surface->AtVertex(VertexId(0)), kTriangle, 0.01, 0.1, far, &doubtful));
}

}  // namespace
}  // namespace meshfront
