// Point sets through the facade: closed surfaces of the right genus, about as many triangles as predicted, the same
// bits again.
#include <algorithm>
#include <cmath>
#include <random>
#include <string>

#include "core/attempts.h"
#include "core/preparation.h"
#include "core/remesh.h"
#include "tests/support/checking_sink.h"
#include "tests/support/matchers.h"
#include "tests/support/shapes.h"

namespace meshfront::testing {
namespace {

absl::StatusOr<Report> RemeshPoints(TriangleMesh points, const RemeshOptions& options, CheckingSink& sink,
                                    int threads = 1) {
  Context context;
  context.threads = threads;
  return Remesh({std::move(points), options}, sink, context);
}

struct Case {
  TriangleMesh mesh;
  int genus;
};

TEST(RemeshPoints, MakesClosedSurfacesOfTheRightGenus) {
  const std::vector<Case> cases = {{Icosphere(4), 0}, {Torus(1, 0.4, 60, 24), 1},          {GenusThree(64), 3},
                                   {Cube(8), 0},      {CappedCylinder(0.5, 2, 40, 20), 0}, {ThinSlab(40, 0.08), 0}};
  for (size_t i = 0; i < cases.size(); ++i) {
    CheckingSink sink;
    const auto report = RemeshPoints(Sampled(cases[i].mesh, 12000), {}, sink);
    ASSERT_THAT(report, IsOk()) << i;
    EXPECT_TRUE(report->complete) << i;
    EXPECT_THAT(sink.mesh(), IsClosedManifold()) << i;
    EXPECT_EQ(MeasureTopology(sink.mesh()).genus, cases[i].genus) << i;
    EXPECT_EQ(report->output.genus, cases[i].genus) << i;
    EXPECT_THAT(sink.mesh(), HasNoSelfIntersection()) << i;
    EXPECT_GE(report->quality.radius_ratio_p0_5, 0.75) << i;
    EXPECT_TRUE(report->input.is_point_set);
    EXPECT_EQ(report->input.topology.components, 1u);
    sink.CheckEnd();
    EXPECT_TRUE(sink.complaints().empty()) << sink.complaints().front();
  }
}

TEST(RemeshPoints, TakesTheOriginalSurfaceAsWell) {
  RemeshOptions options;
  options.surface = SurfaceKind::kMls, options.rho = 1.2;
  const std::vector<Case> cases = {{Torus(1, 0.4, 60, 24), 1}, {Cube(8), 0}};
  for (size_t i = 0; i < cases.size(); ++i) {
    CheckingSink sink;
    const auto report = RemeshPoints(Sampled(cases[i].mesh, 2500), options, sink);
    ASSERT_THAT(report, IsOk()) << i;
    EXPECT_TRUE(report->complete) << i;
    EXPECT_EQ(report->parameters.options.surface, SurfaceKind::kMls);
    EXPECT_THAT(sink.mesh(), IsClosedManifold()) << i;
    EXPECT_EQ(report->output.genus, cases[i].genus) << i;
    EXPECT_THAT(sink.mesh(), HasNoSelfIntersection()) << i;
    EXPECT_GE(report->quality.radius_ratio_p0_5, 0.75) << i;
  }
  CheckingSink open;
  ASSERT_THAT(RemeshPoints(Sampled(DiskWithHoles(60, 3), 6000), options, open), IsOk());
  EXPECT_THAT(open.mesh(), HasBoundaryLoops(4));
}

TEST(RemeshPoints, FindsEveryPart) {
  CheckingSink sink;
  const auto report = RemeshPoints(Sampled(TwoSpheres(4), 8000), {}, sink);
  ASSERT_THAT(report, IsOk());
  EXPECT_THAT(sink.mesh(), IsClosedManifold());
  EXPECT_EQ(report->output.components, 2u);
}

// A bowl and a ball so near to it that their samples are one part: the front from the bowl's rim covers the bowl alone.
TEST(RemeshPoints, CoversWhatTheFirstFrontsLeave) {
  TriangleMesh points = Sampled(Joined(Hemisphere(4), Moved(Icosphere(4), {0, 0, 2.0})), 12000);
  CheckingSink sink;
  const auto report = RemeshPoints(points, {}, sink);
  ASSERT_THAT(report, IsOk());
  const Box3 box = BoundingBox(points), made = BoundingBox(sink.mesh());
  EXPECT_LE(Distance(box.min, made.min) + Distance(box.max, made.max), 0.15);
}

// One loop around each place where the samples end, which lies within a spacing or so of the rim that was sampled.
TEST(RemeshPoints, KeepsRimsOpen) {
  const std::vector<std::pair<TriangleMesh, int>> cases = {
      {Hemisphere(4), 1}, {DiskWithHoles(60, 3), 4}, {OpenCylinder(1, 2, 60, 30), 2}, {WavyTerrain(40), 1}};
  for (size_t i = 0; i < cases.size(); ++i) {
    CheckingSink sink;
    const auto report = RemeshPoints(Sampled(cases[i].first, 12000), {}, sink);
    ASSERT_THAT(report, IsOk()) << i;
    EXPECT_TRUE(report->complete) << i;
    EXPECT_THAT(sink.mesh(), IsManifold()) << i;
    EXPECT_THAT(sink.mesh(), HasBoundaryLoops(cases[i].second)) << i;
    EXPECT_THAT(sink.mesh(), HasNoSelfIntersection()) << i;
    EXPECT_EQ(report->output.genus, 0) << i;
    EXPECT_EQ(report->input.topology.boundary_loops, cases[i].second) << i;
    const Box3 box = BoundingBox(cases[i].first), made = BoundingBox(sink.mesh());
    EXPECT_LE(Distance(box.min, made.min) + Distance(box.max, made.max), 0.15) << i;
  }
}

TEST(RemeshPoints, LiesOnTheSphere) {
  TriangleMesh points = Sampled(Icosphere(4), 8000);
  for (size_t i = 0; i < points.positions.size(); ++i)
    points.normals[i] = points.positions[i] = Normalized(points.positions[i]);
  CheckingSink sink;
  RemeshOptions options;
  options.fit = false;
  ASSERT_THAT(RemeshPoints(points, options, sink), IsOk());
  for (const Vec3& x : sink.mesh().positions) EXPECT_NEAR(Norm(x), 1, 1e-3);
}

TEST(RemeshPoints, NeedsNoNormals) {
  TriangleMesh points = Sampled(Torus(1, 0.4, 60, 24), 8000);
  points.normals.clear();
  CheckingSink sink;
  const auto report = RemeshPoints(points, {}, sink);
  ASSERT_THAT(report, IsOk());
  EXPECT_THAT(sink.mesh(), IsClosedManifold());
  EXPECT_EQ(report->output.genus, 1);
  ASSERT_EQ(report->input.repairs.size(), 1u);
  EXPECT_EQ(report->input.repairs[0].what, "estimated_normals");
}

// Points off a unit sphere, without normals.
TriangleMesh NoisySphere(size_t count, double deviation) {
  TriangleMesh points = Sampled(Icosphere(4), count);
  std::mt19937_64 random(1);
  std::normal_distribution<double> off(1, deviation);
  for (Vec3& x : points.positions) x = off(random) * Normalized(x);
  points.normals.clear();
  return points;
}

bool Mentions(const std::vector<std::string>& warnings, const std::string& words) {
  return std::any_of(warnings.begin(), warnings.end(),
                     [&](const std::string& w) { return w.find(words) != std::string::npos; });
}

TEST(RemeshPoints, SaysThatItTurnsNormals) {
  TriangleMesh points = Sampled(Icosphere(4), 3000);
  CheckingSink right_sink, sink;
  const auto right = RemeshPoints(points, {}, right_sink);
  ASSERT_THAT(right, IsOk());
  EXPECT_FALSE(Mentions(right->warnings, "normals were turned"));
  for (size_t i = 0; i < points.normals.size(); i += 10) points.normals[i] = -1.0 * points.normals[i];
  const auto report = RemeshPoints(points, {}, sink);
  ASSERT_THAT(report, IsOk());
  EXPECT_TRUE(Mentions(report->warnings, "300 of 3000 normals were turned"));
  EXPECT_THAT(sink.mesh(), IsClosedManifold());
}

// Normals that differ from the surface's by 32 degrees: their sides are used, and the sphere comes out as if they were right.
TEST(RemeshPoints, UsesOnlyTheSidesOfNormalsThatAreNoise) {
  TriangleMesh points = Sampled(Icosphere(4), 4000);
  std::mt19937_64 random(1);
  std::normal_distribution<double> off(0, 0.5);
  for (Vec3& n : points.normals) n = Normalized(-1.0 * n + Vec3{off(random), off(random), off(random)});
  CheckingSink sink;
  const auto report = RemeshPoints(points, {}, sink);
  ASSERT_THAT(report, IsOk());
  EXPECT_TRUE(report->complete);
  EXPECT_TRUE(Mentions(report->warnings, "only their sides are used"));
  EXPECT_LT(report->output.triangles, 400u);
  EXPECT_THAT(sink.mesh(), IsClosedManifold());
  const Triangle& t = sink.mesh().triangles[0];
  const Vec3 a = sink.mesh().PositionAt(t[0]), b = sink.mesh().PositionAt(t[1]), c = sink.mesh().PositionAt(t[2]);
  EXPECT_LT(Dot(Cross(b - a, c - a), a), 0);  // inward, as the normals given are
}

TEST(RemeshPoints, SeesPastNoise) {
  CheckingSink sink;
  const auto report = RemeshPoints(NoisySphere(6000, 0.05), {}, sink);
  ASSERT_THAT(report, IsOk());
  EXPECT_THAT(sink.mesh(), IsClosedManifold());
  EXPECT_EQ(report->output.components, 1u);
  EXPECT_EQ(report->output.genus, 0);
  EXPECT_GT(report->parameters.options.mls_radius, 4);
  EXPECT_TRUE(Mentions(report->warnings, "mls_radius"));
  double square = 0;
  for (const Vec3& x : sink.mesh().positions) square += (Norm(x) - 1) * (Norm(x) - 1);
  EXPECT_LE(std::sqrt(square / static_cast<double>(sink.mesh().positions.size())), 0.02);
}

// Where few samples lie to one side of a small gap is no rim.
TEST(RemeshPoints, DoesNotTakeGapsBetweenSamplesForRims) {
  TriangleMesh points = Sampled(Torus(1, 0.4, 60, 24), 8000);
  // Empty: a disc of three spacings.
  for (const Vec3& hole : {Vec3{1.4, 0, 0}, Vec3{-1.4, 0, 0}, Vec3{0, 1, 0.4}}) {
    for (size_t i = points.positions.size(); i-- > 0;) {
      if (Distance(points.positions[i], hole) > 0.125) continue;
      points.positions.erase(points.positions.begin() + static_cast<std::ptrdiff_t>(i));
      points.normals.erase(points.normals.begin() + static_cast<std::ptrdiff_t>(i));
    }
  }
  CheckingSink sink;
  const auto report = RemeshPoints(points, {}, sink);
  ASSERT_THAT(report, IsOk());
  EXPECT_THAT(sink.mesh(), IsClosedManifold());
  EXPECT_EQ(report->output.genus, 1);
}

TEST(RemeshPoints, WidensSupportsThatSeeTooFew) {
  TriangleMesh points = Sampled(Icosphere(4), 3000);
  points.normals = points.positions;
  for (Vec3& n : points.normals) n = Normalized(n);
  RemeshOptions options;
  options.mls_radius = 2;
  CheckingSink sink;
  const auto report = RemeshPoints(points, options, sink);
  ASSERT_THAT(report, IsOk());
  EXPECT_TRUE(report->complete);
  EXPECT_THAT(sink.mesh(), HasNoSelfIntersection());
  EXPECT_TRUE(Mentions(report->warnings, "supports were widened"));
}

TEST(RemeshPoints, MakesNoMoreAttemptsThanItMayLookAtSamples) {
  Problem problem{Sampled(Icosphere(4), 3000), {}};
  problem.mesh.normals = problem.mesh.positions;
  problem.options.mls_radius = 2;
  std::vector<Attempt> attempts;
  for (const double most : {3e9, 1.0}) {
    absl::StatusOr<Preparation> prepared = Prepare(problem, {});
    ASSERT_THAT(prepared, IsOk());
    prepared->most_samples_seen = most;
    CheckingSink sink;
    absl::StatusOr<Attempt> attempt = AdvanceInAttempts(*prepared, sink, {});
    ASSERT_THAT(attempt, IsOk());
    attempts.push_back(*std::move(attempt));
  }
  EXPECT_EQ(attempts[0].fault_count(), 0u);
  EXPECT_GT(attempts[0].widened, 1);
  EXPECT_GT(attempts[1].fault_count(), 0u);
  EXPECT_EQ(attempts[1].widened, 1);
}

TEST(RemeshPoints, KeepsToTheCountWanted) {
  for (const Sizing sizing : {Sizing::kAngle, Sizing::kError, Sizing::kUniform}) {
    RemeshOptions options;
    options.sizing = sizing;
    options.target_triangles = 4000;
    CheckingSink sink;
    const auto report = RemeshPoints(Sampled(GenusThree(64), 20000), options, sink);
    ASSERT_THAT(report, IsOk());
    EXPECT_NEAR(static_cast<double>(sink.mesh().triangles.size()), 4000, 120);
    EXPECT_THAT(sink.mesh(), IsClosedManifold());
  }
}

TEST(RemeshPoints, GivesTheSameBitsAtAnyNumberOfThreads) {
  const TriangleMesh points = Sampled(Torus(1, 0.4, 60, 24), 6000);
  CheckingSink one, three;
  ASSERT_THAT(RemeshPoints(points, {}, one, 1), IsOk());
  ASSERT_THAT(RemeshPoints(points, {}, three, 3), IsOk());
  EXPECT_EQ(one.mesh().positions, three.mesh().positions);
  EXPECT_EQ(one.mesh().triangles, three.mesh().triangles);
}

TEST(RemeshPoints, SaysWhatItCanNotTake) {
  const TriangleMesh points = Sampled(Icosphere(2), 500);
  CheckingSink sink;
  RemeshOptions options;
  options.surface = SurfaceKind::kMesh;
  EXPECT_THAT(RemeshPoints(points, options, sink), StatusIs(absl::StatusCode::kInvalidArgument, "no triangles"));
  options.surface = SurfaceKind::kAuto, options.mls_radius = 1;
  EXPECT_THAT(RemeshPoints(points, options, sink), StatusIs(absl::StatusCode::kInvalidArgument, "options.mls_radius"));
}

TEST(RemeshPoints, SaysWhenPointsAreNoSurface) {
  TriangleMesh points;
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> along(-1, 1);
  for (int i = 0; i < 1000; ++i) points.positions.push_back({along(random), along(random), along(random)});
  CheckingSink sink;
  EXPECT_THAT(RemeshPoints(points, {}, sink), StatusIs(absl::StatusCode::kFailedPrecondition, "volume"));
}

TEST(EstimateRemesh, PredictsTheTrianglesOfAPointSet) {
  const TriangleMesh points = Sampled(GenusThree(64), 20000);
  CheckingSink sink;
  const auto report = RemeshPoints(points, {}, sink);
  const auto estimate = EstimateRemesh({points, {}}, Context{});
  ASSERT_THAT(report, IsOk());
  ASSERT_THAT(estimate, IsOk());
  EXPECT_EQ(estimate->predicted_triangles, report->predicted_triangles);
  EXPECT_NEAR(static_cast<double>(report->predicted_triangles), static_cast<double>(report->output.triangles),
              0.05 * static_cast<double>(report->output.triangles));
  EXPECT_GT(estimate->edge_median, estimate->edge_min);
}

}  // namespace
}  // namespace meshfront::testing
