// Meshes and soups that are meshed as point sets: what is wrong with their faces is gone, and what was done is said.
#include <algorithm>

#include "core/remesh.h"
#include "tests/support/checking_sink.h"
#include "tests/support/matchers.h"
#include "tests/support/shapes.h"
#include "tests/support/textured.h"

namespace meshfront::testing {
namespace {

RemeshOptions Sampled(SurfaceKind surface) {
  RemeshOptions options;
  options.surface = surface;
  return options;
}

uint64_t SampledPoints(const Report& report) {
  for (const RepairAction& action : report.input.repairs) {
    if (action.what == "sampled_points") return action.count;
  }
  return 0;
}

// A sphere with flipped and missing faces, some of them doubled a little farther out.
TriangleMesh BrokenSphere() {
  TriangleMesh mesh = Soup(Icosphere(4));
  std::vector<Triangle> kept;
  for (size_t i = 0; i < mesh.triangles.size(); ++i) {
    Triangle t = mesh.triangles[i];
    if (i % 61 == 7) continue;
    if (i % 17 == 3) std::swap(t[1], t[2]);
    kept.push_back(t);
    if (i % 29 != 5) continue;
    Triangle above;
    for (int corner = 0; corner < 3; ++corner) {
      above[corner] = VertexId(static_cast<uint32_t>(mesh.positions.size()));
      mesh.positions.push_back(1.002 * mesh.PositionAt(mesh.triangles[i][corner]));
    }
    kept.push_back(above);
  }
  mesh.triangles = kept;
  return mesh;
}

TEST(RemeshSampled, HealsFlippedMissingAndDoubledFaces) {
  RemeshOptions options = Sampled(SurfaceKind::kImls);
  options.sizing = Sizing::kUniform, options.edge_length = Length{0.25, false};
  CheckingSink sink;
  const auto report = Remesh({BrokenSphere(), options}, sink, Context{});
  ASSERT_THAT(report, IsOk());
  EXPECT_TRUE(report->complete);
  EXPECT_THAT(sink.mesh(), IsClosedManifold());
  EXPECT_EQ(report->output.genus, 0);
  EXPECT_THAT(sink.mesh(), HasNoSelfIntersection());
  for (const Vec3& x : sink.mesh().positions) EXPECT_NEAR(Norm(x), 1, 0.03);
}

TEST(RemeshSampled, SaysWhatIsNotInForce) {
  RemeshOptions options = Sampled(SurfaceKind::kImls);
  options.sizing = Sizing::kUniform, options.edge_length = Length{0.3, false};
  CheckingSink sink;
  const auto sampled = Remesh({Icosphere(3), options}, sink, Context{});
  ASSERT_THAT(sampled, IsOk());
  EXPECT_FALSE(sampled->parameters.options.attributes);
  EXPECT_FALSE(sampled->parameters.options.crease_angle.has_value());
  RemeshOptions of_mesh;
  of_mesh.mls_radius = 6;
  CheckingSink other;
  const auto meshed = Remesh({Icosphere(3), of_mesh}, other, Context{});
  ASSERT_THAT(meshed, IsOk());
  EXPECT_THAT(meshed->warnings, ::testing::Contains(::testing::HasSubstr("mls_radius does nothing on a mesh")));
}

// Two balls and, inside of one of them, a third, which meets nothing and stays.
TEST(RemeshSampled, MakesOneOfPartsThatOverlap) {
  const TriangleMesh two = Joined(Icosphere(3), Moved(Icosphere(3), {1, 0.13, 0.07}));
  RemeshOptions options = Sampled(SurfaceKind::kImls);
  options.sizing = Sizing::kUniform, options.edge_length = Length{0.2, false};
  CheckingSink sink;
  const auto report = Remesh({Joined(two, Moved(Icosphere(2, 0.2), {-0.5, 0, 0})), options}, sink, Context{});
  ASSERT_THAT(report, IsOk());
  EXPECT_EQ(report->input.topology.components, 3u);
  EXPECT_THAT(sink.mesh(), IsClosedManifold());
  EXPECT_THAT(sink.mesh(), HasComponents(2));
  EXPECT_THAT(sink.mesh(), HasNoSelfIntersection());
  EXPECT_EQ(report->input.repairs[0].what, "dropped_inner_points");
}

TEST(RemeshSampled, SaysWhatItDid) {
  TriangleMesh mesh = Textured(Torus(1, 0.4, 40, 16), AroundZ);
  CheckingSink sink;
  RemeshOptions options = Sampled(SurfaceKind::kImls);
  options.rho = 1.4, options.surface = SurfaceKind::kMls;
  const auto report = Remesh({mesh, options}, sink, Context{});
  ASSERT_THAT(report, IsOk());
  EXPECT_FALSE(report->input.is_point_set);
  EXPECT_EQ(report->input.topology.triangles, mesh.triangles.size());
  EXPECT_EQ(report->input.topology.genus, 1);
  EXPECT_EQ(report->output.genus, 1);
  EXPECT_EQ(report->parameters.options.surface, SurfaceKind::kMls);
  EXPECT_GE(SampledPoints(*report), 19900u);
  ASSERT_EQ(report->warnings.size(), 2u);
  EXPECT_THAT(report->warnings[0], ::testing::HasSubstr("attributes are dropped"));
  EXPECT_THAT(report->warnings[1], ::testing::HasSubstr(std::to_string(SampledPoints(*report)) + " points"));
}

TEST(RemeshSampled, TakesNoRegionYet) {
  CheckingSink sink;
  Problem problem{Icosphere(2), Sampled(SurfaceKind::kMls), Region{RegionSphere{{0, 0, 1}, 0.5}}};
  EXPECT_THAT(Remesh(problem, sink, Context{}), StatusIs(absl::StatusCode::kInvalidArgument, "not yet"));
}

}  // namespace
}  // namespace meshfront::testing
