// Levels of detail: one preparation, and meshes that are those of as many problems of their own.
#include <vector>

#include "core/remesh.h"
#include "tests/support/checking_sink.h"
#include "tests/support/matchers.h"
#include "tests/support/shapes.h"

namespace meshfront::testing {
namespace {

class LevelCollector : public LevelSink {
 public:
  MeshSink& BeginLevel() override { return meshes.emplace_back(); }
  absl::Status EndLevel(const Report& report) override {
    reports.push_back(report);
    return reports.size() == stops_at ? absl::AbortedError("enough") : absl::OkStatus();
  }

  size_t stops_at = 0;
  std::vector<CollectingSink> meshes;
  std::vector<Report> reports;
};

RemeshOptions ByLevels(std::vector<double> rhos) {
  RemeshOptions options;
  options.lod_rhos = std::move(rhos);
  return options;
}

void ExpectLevelsAsAlone(const TriangleMesh& mesh, const std::vector<double>& rhos, double mls_radius = 4) {
  LevelCollector levels;
  RemeshOptions all = ByLevels(rhos);
  all.mls_radius = mls_radius;
  ASSERT_THAT(RemeshLevels({mesh, all}, levels, {}), IsOk());
  ASSERT_EQ(levels.reports.size(), rhos.size());
  for (size_t i = 0; i < rhos.size(); ++i) {
    RemeshOptions options;
    options.rho = rhos[i];
    options.mls_radius = mls_radius;
    CollectingSink alone;
    const absl::StatusOr<Report> report = Remesh({mesh, options}, alone, {});
    ASSERT_THAT(report, IsOk());
    EXPECT_TRUE(alone.mesh.positions == levels.meshes[i].mesh.positions) << "level " << i;
    EXPECT_TRUE(alone.mesh.triangles == levels.meshes[i].mesh.triangles) << "level " << i;
    const Report& of_level = levels.reports[i];
    EXPECT_EQ(of_level.predicted_triangles, report->predicted_triangles);
    EXPECT_EQ(of_level.error_bound, report->error_bound);
    EXPECT_EQ(of_level.parameters.options.rho, rhos[i]);
    EXPECT_TRUE(of_level.complete);
    EXPECT_TRUE(of_level.output.closed == report->output.closed);
  }
}

TEST(RemeshLevels, MakesTheMeshesThatProblemsOfTheirOwnMake) {
  ExpectLevelsAsAlone(Icosphere(3), {0.4, 0.8, 1.5});
  ExpectLevelsAsAlone(Cube(3), {0.5, 1.2});
}

// A tube around a rod: attempts at one level halve the edges around its rims and cut faces loose, and the next one must not see that.
TEST(RemeshLevels, BeginEachLevelWhereTheFirstBegan) {
  ExpectLevelsAsAlone(Joined(OpenCylinder(1, 2, 48, 12), CappedCylinder(0.97, 3, 48, 16)), {1.0, 1.5});
}

// Attempts at one level make the supports of the samples wider.
TEST(RemeshLevels, BeginEachLevelOnTheSurfaceThatThePointsHadFirst) {
  TriangleMesh points = Sampled(Icosphere(4), 3000);
  points.normals = points.positions;
  for (Vec3& n : points.normals) n = Normalized(n);
  ExpectLevelsAsAlone(points, {0.5, 0.8, 1.2}, 2);
}

TEST(RemeshLevels, RepairAndMeasureOnce) {
  LevelCollector levels;
  ASSERT_THAT(RemeshLevels({Icosphere(3), ByLevels({0.8, 1.5})}, levels, {}), IsOk());
  EXPECT_GT(levels.reports[0].seconds.curvature, 0);
  EXPECT_EQ(levels.reports[1].seconds.curvature, 0);
  EXPECT_GT(levels.reports[1].seconds.mesh, 0);
}

TEST(RemeshLevels, EndWithTheStatusOfTheSink) {
  LevelCollector levels;
  levels.stops_at = 1;
  EXPECT_THAT(RemeshLevels({Icosphere(2), ByLevels({0.8, 1.5})}, levels, {}),
              StatusIs(absl::StatusCode::kAborted, "enough"));
  EXPECT_EQ(levels.meshes.size(), 1u);
}

TEST(RemeshLevels, RefuseWhatIsNoChain) {
  const auto refused = [](const RemeshOptions& options, const char* what) {
    LevelCollector levels;
    EXPECT_THAT(RemeshLevels({Icosphere(1), options}, levels, {}), StatusIs(absl::StatusCode::kInvalidArgument, what));
  };
  refused({}, "options.lod_rhos is empty");
  refused(ByLevels({0.8, 0.8}), "options.lod_rhos[1] is 0.8");
  refused(ByLevels({0.0}), "options.lod_rhos[0] is 0");
  refused(ByLevels({0.5, 2.2}), "options.lod_rhos[1] is 2.2");
  refused(ByLevels(std::vector<double>(17, 1.0)), "at most 16");
  RemeshOptions counted = ByLevels({0.8});
  counted.target_triangles = 100;
  refused(counted, "target_triangles");
  RemeshOptions by_error = ByLevels({0.8});
  by_error.sizing = Sizing::kError;
  refused(by_error, "sizing error");
  LevelCollector levels;
  EXPECT_THAT(RemeshLevels({Icosphere(1), ByLevels({0.8}), Region{RegionSphere{{0, 0, 1}, 0.5}}}, levels, {}),
              StatusIs(absl::StatusCode::kInvalidArgument, "options.region"));
  CollectingSink sink;
  EXPECT_THAT(Remesh({Icosphere(1), ByLevels({0.8})}, sink, {}),
              StatusIs(absl::StatusCode::kInvalidArgument, "RemeshLevels"));
}

}  // namespace
}  // namespace meshfront::testing
