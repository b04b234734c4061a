// Gaps that are closed before meshing: of point sets where the samples end, of meshes their holes.
#include <algorithm>
#include <cmath>
#include <string>

#include "core/remesh.h"
#include "tests/support/checking_sink.h"
#include "tests/support/matchers.h"
#include "tests/support/shapes.h"
#include "tests/support/textured.h"

namespace meshfront::testing {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

RemeshOptions WithGapsUpTo(double size, bool relative = false) {
  RemeshOptions options;
  options.fill_gaps = Length{size, relative};
  return options;
}

uint64_t CountOf(const Report& report, const std::string& what) {
  uint64_t count = 0;
  for (const RepairAction& action : report.input.repairs) count += action.what == what ? action.count : 0;
  return count;
}

TriangleMesh WithoutBall(const TriangleMesh& mesh, const Vec3& center, double radius) {
  return Clipped(mesh, [=](const Vec3& x) { return radius - Distance(x, center); });
}

void ExpectGood(const Report& report, const CheckingSink& sink) {
  EXPECT_TRUE(report.complete);
  EXPECT_THAT(sink.mesh(), IsManifold());
  EXPECT_THAT(sink.mesh(), HasNoSelfIntersection());
  EXPECT_GE(report.quality.radius_ratio_p0_5, 0.75);
}

TEST(RemeshGaps, ClosesAHoleInTheSamplesOfASphereAsTheSphereGoesOn) {
  const TriangleMesh points = Sampled(WithoutBall(Icosphere(4), {0, 0, 1}, 0.4), 8000);
  RemeshOptions options = WithGapsUpTo(1);
  options.fit = false;
  CheckingSink sink;
  const auto report = Remesh({points, options}, sink, Context{});
  ASSERT_THAT(report, IsOk());
  ExpectGood(*report, sink);
  EXPECT_THAT(sink.mesh(), IsClosedManifold());
  EXPECT_EQ(CountOf(*report, "filled_gaps"), 1u);
  EXPECT_THAT(report->warnings, IsEmpty());
  double farthest = 0;
  for (const Vec3& x : sink.mesh().positions) farthest = std::max(farthest, std::abs(Norm(x) - 1));
  EXPECT_LE(farthest, 0.006);  // a flat patch is up to 0.08 away
}

TEST(RemeshGaps, LeavesRimsThatAreLarger) {
  const TriangleMesh points = Sampled(WithoutBall(Hemisphere(4), {0, 0, 1}, 0.3), 8000);
  CheckingSink sink;
  const auto report = Remesh({points, WithGapsUpTo(0.3, true)}, sink, Context{});
  ASSERT_THAT(report, IsOk());
  ExpectGood(*report, sink);
  EXPECT_THAT(sink.mesh(), HasBoundaryLoops(1));
  EXPECT_EQ(CountOf(*report, "filled_gaps"), 1u);
  EXPECT_EQ(CountOf(*report, "gaps_left_open"), 0u);
  EXPECT_NEAR(report->parameters.options.fill_gaps->value, 0.3 * report->input.diagonal, 1e-12);
}

TEST(RemeshGaps, ClosesHolesOfATorusByItsOriginalSurfaceAsWell) {
  const TriangleMesh holes = WithoutBall(WithoutBall(Torus(1, 0.4, 60, 24), {1.4, 0, 0}, 0.35), {-1, 0, 0.4}, 0.3);
  for (const SurfaceKind kind : {SurfaceKind::kImls, SurfaceKind::kMls}) {
    RemeshOptions options = WithGapsUpTo(0.8);
    options.surface = kind;
    CheckingSink sink;
    const auto report = Remesh({Sampled(holes, 5000), options}, sink, Context{});
    ASSERT_THAT(report, IsOk());
    ExpectGood(*report, sink);
    EXPECT_THAT(sink.mesh(), IsClosedManifold());
    EXPECT_EQ(report->output.genus, 1);
    EXPECT_EQ(CountOf(*report, "filled_gaps"), 2u);
  }
}

// The patch of a hole in a thin shell's outer side would have to pass through the ball in the hole.
TEST(RemeshGaps, SaysWhichGapNoPatchCloses) {
  const TriangleMesh shell = WithoutBall(Icosphere(4), {0, 0, 1}, 0.5);
  const TriangleMesh blocked = Joined(shell, Moved(Icosphere(3, 0.2), {0, 0, 1}));
  for (const bool as_points : {true, false}) {
    CheckingSink sink;
    const auto report = Remesh({as_points ? Sampled(blocked, 9000) : blocked, WithGapsUpTo(1.2)}, sink, Context{});
    ASSERT_THAT(report, IsOk());
    EXPECT_THAT(sink.mesh(), HasBoundaryLoops(1)) << as_points;
    EXPECT_EQ(CountOf(*report, "filled_gaps"), 0u) << as_points;
    EXPECT_EQ(CountOf(*report, "gaps_left_open"), 1u) << as_points;
    EXPECT_THAT(report->warnings, Contains(HasSubstr("1 gaps that are no wider than fill_gaps (1.2) stay open")));
  }
}

TEST(RemeshGaps, ClosesHolesOfAMeshUpToTheirDiameter) {
  const TriangleMesh mesh = DiskWithHoles(60, 3);
  CheckingSink none, small, all;
  const auto without = Remesh({mesh, {}}, none, Context{});
  const auto with = Remesh({mesh, WithGapsUpTo(0.35)}, small, Context{});
  ASSERT_THAT(without, IsOk());
  ASSERT_THAT(with, IsOk());
  EXPECT_EQ(CountOf(*without, "filled_gaps"), 0u);
  EXPECT_THAT(none.mesh(), HasBoundaryLoops(4));
  ExpectGood(*with, small);
  EXPECT_EQ(CountOf(*with, "filled_gaps"), 3u);
  EXPECT_THAT(small.mesh(), HasBoundaryLoops(1));
  EXPECT_EQ(with->input.topology.boundary_loops, 1u);
  // The rim of a sheet is no hole: the patch would lie on the sheet or bulge over it, and closes it only where it can.
  const auto flat = Remesh({Sheet(8), WithGapsUpTo(5)}, all, Context{});
  ASSERT_THAT(flat, IsOk());
  EXPECT_EQ(CountOf(*flat, "gaps_left_open"), 1u);
}

TEST(RemeshGaps, ClosesHolesBeforeAMeshIsSampled) {
  RemeshOptions options = WithGapsUpTo(1);
  options.surface = SurfaceKind::kImls, options.sizing = Sizing::kUniform, options.edge_length = Length{0.2, false};
  CheckingSink sink;
  const auto report = Remesh({WithoutBall(Icosphere(4), {0, 0, 1}, 0.4), options}, sink, Context{});
  ASSERT_THAT(report, IsOk());
  EXPECT_THAT(sink.mesh(), IsClosedManifold());
  EXPECT_EQ(CountOf(*report, "filled_gaps"), 1u);
}

TEST(RemeshGaps, GoOnWithTheAttributesOfTheRim) {
  const TriangleMesh mesh = Textured(WithoutBall(Sheet(20), {0, 0, 0}, 0.3), [](const Vec3& x, const Vec3&) {
    return std::array<double, 2>{x.x, x.y};
  });
  CollectingSink sink;
  sink.mesh.attributes.channels = mesh.attributes.channels;
  const auto report = Remesh({mesh, WithGapsUpTo(0.7)}, sink, Context{});
  ASSERT_THAT(report, IsOk());
  EXPECT_EQ(CountOf(*report, "filled_gaps"), 1u);
  const MeshAttributes& attributes = sink.mesh.attributes;
  ASSERT_EQ(attributes.corners.size(), sink.mesh.triangles.size());
  for (size_t f = 0; f < attributes.corners.size(); ++f) {
    for (int i = 0; i < 3; ++i) {
      const Vec3& x = sink.mesh.PositionAt(sink.mesh.triangles[f][i]);
      EXPECT_NEAR(attributes.WedgeAt(attributes.corners[f][i])[0], x.x, 0.1);
      EXPECT_NEAR(attributes.WedgeAt(attributes.corners[f][i])[1], x.y, 0.1);
    }
  }
}

TEST(RemeshGaps, AreNotFilledBesideARegion) {
  Problem problem{Icosphere(2), WithGapsUpTo(1)};
  problem.region = Region{RegionSphere{{0, 0, 1}, 0.5}};
  CheckingSink sink;
  EXPECT_THAT(Remesh(problem, sink, Context{}), StatusIs(absl::StatusCode::kInvalidArgument, "options.fill_gaps"));
  EXPECT_THAT(Remesh({Icosphere(2), WithGapsUpTo(-1)}, sink, Context{}),
              StatusIs(absl::StatusCode::kInvalidArgument, "options.fill_gaps is -1"));
}

}  // namespace
}  // namespace meshfront::testing
