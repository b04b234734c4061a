// Point sets with sharp edges through the facade: edges and corners come back, and nothing else is taken for one.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "core/remesh.h"
#include "tests/support/checking_sink.h"
#include "tests/support/matchers.h"
#include "tests/support/shapes.h"

namespace meshfront::testing {
namespace {

using ::testing::AnyOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr char kFound[] = "creases were found on the point set";

TriangleMesh WithoutNormals(TriangleMesh points) {
  points.normals.clear();
  return points;
}

TriangleMesh WithDeviation(TriangleMesh points, double deviation) {
  std::mt19937_64 random(7);
  std::normal_distribution<double> off(0, deviation);
  for (Vec3& x : points.positions) x += Vec3{off(random), off(random), off(random)};
  return points;
}

absl::StatusOr<Report> RemeshSharp(TriangleMesh points, CheckingSink& sink, RemeshOptions options = {}) {
  return Remesh({std::move(points), options}, sink, Context{});
}

void ExpectWhole(const absl::StatusOr<Report>& report, const CheckingSink& sink, double least_shape = 0.75) {
  ASSERT_THAT(report, IsOk());
  EXPECT_TRUE(report->complete);
  EXPECT_TRUE(report->input.is_point_set);
  EXPECT_THAT(sink.mesh(), IsClosedManifold());
  EXPECT_EQ(report->output.genus, 0);
  EXPECT_THAT(sink.mesh(), HasNoSelfIntersection());
  EXPECT_GE(report->quality.radius_ratio_p0_5, least_shape);
}

double DistanceToVertices(const TriangleMesh& mesh, const Vec3& x) {
  double nearest = INFINITY;
  for (const Vec3& v : mesh.positions) nearest = std::min(nearest, Distance(v, x));
  return nearest;
}

// How far a vertex is from the cube [-1, 1]³ at the most.
double FarthestFromCube(const TriangleMesh& mesh) {
  double farthest = 0;
  for (const Vec3& v : mesh.positions)
    farthest = std::max(farthest, std::abs(std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}) - 1));
  return farthest;
}

double FarthestCorner(const TriangleMesh& mesh) {
  double farthest = 0;
  for (const double x : {-1, 1}) {
    for (const double y : {-1, 1}) {
      for (const double z : {-1, 1}) farthest = std::max(farthest, DistanceToVertices(mesh, {x, y, z}));
    }
  }
  return farthest;
}

// Of normals that are noise only the sides are taken: the planes' own tell where the edges are, as of points that have none.
TEST(SharpPoints, KeepEdgesWhereTheirNormalsAreNoise) {
  TriangleMesh points = Sampled(Cube(1), 8000);
  std::mt19937_64 random(11);
  std::normal_distribution<double> off(0, 0.4);
  for (Vec3& n : points.normals) n = Normalized(n + Vec3{off(random), off(random), off(random)});
  CheckingSink sink;
  const auto report = RemeshSharp(points, sink);
  ExpectWhole(report, sink);
  EXPECT_THAT(report->warnings, Contains(HasSubstr(kFound)));
  EXPECT_LT(FarthestCorner(sink.mesh()), 8e-3);
}

TEST(SharpPoints, KeepTheEdgesAndCornersOfACube) {
  CheckingSink sink;
  const auto report = RemeshSharp(Sampled(Cube(1), 6000), sink);
  ExpectWhole(report, sink);
  EXPECT_THAT(report->warnings, Contains(HasSubstr("12 curves that meet at 8 corners")));
  EXPECT_LT(FarthestFromCube(sink.mesh()), 1e-6);
  EXPECT_LT(FarthestCorner(sink.mesh()), 1e-6);
}

TEST(SharpPoints, KeepThemWithoutNormals) {
  CheckingSink sink;
  const auto report = RemeshSharp(WithoutNormals(Sampled(Cube(1), 8000)), sink);
  ExpectWhole(report, sink);
  EXPECT_LT(FarthestFromCube(sink.mesh()), 2e-3);
  EXPECT_LT(FarthestCorner(sink.mesh()), 8e-3);
}

TEST(SharpPoints, KeepThemInNoise) {
  CheckingSink sink;
  const auto report = RemeshSharp(WithDeviation(Sampled(Cube(1), 12000), 0.004), sink);
  ExpectWhole(report, sink);
  EXPECT_LT(FarthestFromCube(sink.mesh()), 0.008);
  EXPECT_LT(FarthestCorner(sink.mesh()), 0.012);
}

TEST(SharpPoints, KeepTheRimsOfACylinder) {
  CheckingSink sink;
  RemeshOptions options;
  options.rho = 0.5, options.fit = false;  // vertices on the surface, not where it fits best between them
  const auto report = RemeshSharp(Sampled(CappedCylinder(1, 2, 160, 8), 8000), sink, options);
  ExpectWhole(report, sink);
  EXPECT_THAT(report->warnings, Contains(HasSubstr("2 curves that meet at 0 corners")));
  double low = 1, high = -1;
  for (const Vec3& v : sink.mesh().positions) low = std::min(low, v.z), high = std::max(high, v.z);
  for (const Vec3& v : sink.mesh().positions) {
    const double from_side = std::hypot(v.x, v.y) - 1, from_cap = std::min(v.z - low, high - v.z);
    EXPECT_LT(std::min(std::abs(from_side), from_cap), 4e-3);
  }
  EXPECT_NEAR(high - low, 2, 1e-3);
}

// Corners of 90°, 45° and 45°: the surface turns by up to 135°. The mesh that edges are looked for on is often not whole there, and a warning
// says so then.
TEST(SharpPoints, KeepAcuteEdgesOrSayThatTheyAreRound) {
  const double angle = std::numbers::pi / 2;
  int kept = 0;
  for (const int count : {9000, 9500, 10000, 10500}) {
    CheckingSink sink;
    const auto report = RemeshSharp(Sampled(Wedge(angle), count), sink);
    ASSERT_THAT(report, IsOk());
    EXPECT_TRUE(report->complete);
    EXPECT_THAT(sink.mesh(), IsClosedManifold());
    EXPECT_THAT(sink.mesh(), HasNoSelfIntersection());
    double farthest = 0;  // of the corners from the next vertex
    for (const double z : {0, 2}) {
      for (const Vec3& corner : {Vec3{0, 0, z}, Vec3{2, 0, z}, Vec3{2 * std::cos(angle), 2 * std::sin(angle), z}})
        farthest = std::max(farthest, DistanceToVertices(sink.mesh(), corner));
    }
    if (farthest < 1e-3) {
      ++kept;
      EXPECT_THAT(report->warnings, Contains(HasSubstr("meet at 6 corners")));
    } else {
      EXPECT_THAT(report->warnings, Contains(AnyOf(HasSubstr("are rounded"), HasSubstr("stay round"))));
    }
  }
  EXPECT_GE(kept, 2);
}

// Between its sides a prism over an octagon turns by 45°.
TEST(SharpPoints, KeepObtuseEdges) {
  std::vector<Vec3> octagon;
  for (int i = 0; i < 8; ++i)
    octagon.push_back({std::cos(i * std::numbers::pi / 4), std::sin(i * std::numbers::pi / 4), 0});
  CheckingSink sink;
  const auto report = RemeshSharp(Sampled(Extruded(Fan(octagon), 1), 12000), sink);
  ExpectWhole(report, sink);
  EXPECT_THAT(report->warnings, Contains(HasSubstr("24 curves that meet at 16 corners")));
  for (const Vec3& corner : octagon) {
    EXPECT_LT(DistanceToVertices(sink.mesh(), corner), 1e-3);
    EXPECT_LT(DistanceToVertices(sink.mesh(), corner + Vec3{0, 0, 1}), 1e-3);
  }
}

TEST(SharpPoints, FollowTheCreaseAngle) {
  RemeshOptions options;
  const TriangleMesh points = Sampled(Cube(1), 6000);
  for (const std::optional<double> angle : {std::optional<double>(95), std::optional<double>()}) {
    options.crease_angle = angle;
    CheckingSink sink;
    const auto report = RemeshSharp(points, sink, options);
    ASSERT_THAT(report, IsOk());
    EXPECT_THAT(report->warnings, Not(Contains(HasSubstr(kFound))));
    EXPECT_GT(FarthestCorner(sink.mesh()), 0.005);
  }
}

TEST(SharpPoints, AreNotFoundWhereAllIsRoundOrNoise) {
  const TriangleMesh round = Sampled(RoundedBox({0.8, 0.8, 0.8}, 0.2, 8, 6), 8000);
  const TriangleMesh noisy = WithDeviation(Sampled(Icosphere(4), 8000), 0.02);
  RemeshOptions off;
  off.crease_angle = std::nullopt;
  for (const TriangleMesh& points : {round, WithoutNormals(round), noisy, WithoutNormals(noisy)}) {
    CheckingSink with, without;
    const auto report = RemeshSharp(points, with);
    ASSERT_THAT(report, IsOk());
    ASSERT_THAT(RemeshSharp(points, without, off), IsOk());
    EXPECT_THAT(report->warnings, Not(Contains(HasSubstr(kFound))));
    EXPECT_EQ(with.mesh().positions, without.mesh().positions);
    EXPECT_EQ(with.mesh().triangles, without.mesh().triangles);
  }
}

TEST(SharpPoints, AreTheSameOnTwoThreads) {
  const TriangleMesh points = Sampled(Cube(1), 3000);
  CheckingSink one, two;
  Context context;
  ASSERT_THAT(Remesh({points, {}}, one, context), IsOk());
  context.threads = 2;
  ASSERT_THAT(Remesh({points, {}}, two, context), IsOk());
  EXPECT_EQ(one.mesh().positions, two.mesh().positions);
  EXPECT_EQ(one.mesh().triangles, two.mesh().triangles);
}

}  // namespace
}  // namespace meshfront::testing
