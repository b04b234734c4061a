// Inputs with slivers, whose normals say nothing, come out as those without.
#include <algorithm>
#include <array>
#include <set>
#include <string>
#include <utility>

#include "core/remesh.h"
#include "tests/support/checking_sink.h"
#include "tests/support/matchers.h"
#include "tests/support/shapes.h"
#include "tests/support/slivers.h"

namespace meshfront::testing {
namespace {

using ::testing::IsEmpty;

Report RemeshOrFail(const TriangleMesh& input, const RemeshOptions& options) {
  CheckingSink sink;
  absl::StatusOr<Report> report = Remesh({input, options}, sink, Context{});
  EXPECT_THAT(report, IsOk());
  if (!report.ok()) return {};
  sink.CheckEnd();
  EXPECT_THAT(sink.complaints(), IsEmpty());
  EXPECT_THAT(sink.mesh(), IsClosedManifold());
  return *std::move(report);
}

// The corners from the smallest on.
using Place = std::array<double, 3>;
std::array<Place, 3> CornersOf(const TriangleMesh& mesh, const Triangle& t) {
  std::array<Place, 3> corners;
  for (int i = 0; i < 3; ++i) corners[i] = {mesh.PositionAt(t[i]).x, mesh.PositionAt(t[i]).y, mesh.PositionAt(t[i]).z};
  std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
  return corners;
}

uint64_t CountOf(const std::vector<RepairAction>& repairs, const std::string& what) {
  for (const RepairAction& action : repairs) {
    if (action.what == what) return action.count;
  }
  return 0;
}

TEST(RemeshWithSlivers, CapsAlongAnEdgeMakeNoNeedles) {
  for (const double rho : {0.5, 1.0, 1.5}) {
    SCOPED_TRACE(rho);
    RemeshOptions options;
    options.rho = rho;
    const Report plain = RemeshOrFail(Cube(4), options), with_caps = RemeshOrFail(CubeWithCaps(4, 1e-4), options);
    EXPECT_EQ(CountOf(with_caps.input.repairs, "flipped_caps"), 8u);
    EXPECT_GT(with_caps.quality.radius_ratio_min, 0.5);
    EXPECT_LT(with_caps.predicted_triangles, 2 * plain.predicted_triangles + 100);
  }
}

TEST(RemeshWithSlivers, NeedlesOnASmoothSurfaceAreNoCreases) {
  const Report report = RemeshOrFail(WithNeedles(Icosphere(4), 0.02, 1), {});
  EXPECT_GT(report.quality.radius_ratio_p0_5, 0.5);
  EXPECT_GT(report.quality.radius_ratio_min, 0.25);
}

// Half of the caps lie in the region: what is beside it stays as it was.
TEST(RemeshWithSlivers, MendsThoseOfARegionToo) {
  const TriangleMesh input = CubeWithCaps(8, 1e-4);
  const Box3 box{{-1.01, -1.01, -1.01}, {0.3, 1.01, 1.01}};
  CollectingSink sink;
  const auto report = Remesh({input, {}, Region{box}}, sink, Context{});
  ASSERT_THAT(report, IsOk());
  const uint64_t mended = CountOf(report->input.repairs, "flipped_caps");
  EXPECT_GT(mended, 0u);
  EXPECT_LT(mended, 16u);
  EXPECT_TRUE(report->complete);
  EXPECT_THAT(sink.mesh, IsClosedManifold());
  std::set<std::array<Place, 3>> faces;
  for (const Triangle& t : sink.mesh.triangles) faces.insert(CornersOf(sink.mesh, t));
  for (const Triangle& t : input.triangles) {
    const auto is_inside = [&](VertexId v) { return input.PositionAt(v).x <= box.max.x; };
    if (std::all_of(t.begin(), t.end(), is_inside)) continue;
    EXPECT_TRUE(faces.contains(CornersOf(input, t)));
  }
}

TEST(RemeshWithSlivers, NothingIsMendedWhereNoneMayBe) {
  RemeshOptions off;
  off.repair = false;
  EXPECT_THAT(RemeshOrFail(CubeWithCaps(4, 1e-4), off).input.repairs, IsEmpty());
  RemeshOptions tight;  // the caps are 1.4e-4 high
  tight.sizing = Sizing::kError;
  tight.max_error = Length{2e-4, false};
  EXPECT_THAT(RemeshOrFail(CubeWithCaps(4, 1e-4), tight).input.repairs, IsEmpty());
}

TEST(RemeshWithSlivers, RepairInputIsWhatIsMeshed) {
  const auto repaired = RepairInput(CubeWithCaps(4, 1e-4), {}, Context{});
  ASSERT_THAT(repaired, IsOk());
  EXPECT_EQ(CountOf(repaired->actions, "flipped_caps"), 8u);
  const Report report = RemeshOrFail(CubeWithCaps(4, 1e-4), {}), again = RemeshOrFail(repaired->mesh, {});
  EXPECT_EQ(report.output.triangles, again.output.triangles);
  EXPECT_THAT(again.input.repairs, IsEmpty());
}

// A face the wrong way round beside the caps.
TEST(RemeshWithSlivers, RepairInputLeavesThemWithoutCreasesAndWithoutLeave) {
  TriangleMesh input = CubeWithCaps(4, 1e-4);
  std::swap(input.triangles[0][1], input.triangles[0][2]);
  RemeshOptions smooth, off;
  smooth.crease_angle.reset();
  off.repair = false;
  for (const RemeshOptions& options : {smooth, off}) {
    const auto repaired = RepairInput(input, options, Context{});
    ASSERT_THAT(repaired, IsOk());
    EXPECT_EQ(CountOf(repaired->actions, "reversed_faces"), 1u);
    EXPECT_EQ(CountOf(repaired->actions, "flipped_caps"), 0u);
    EXPECT_EQ(repaired->mesh.triangles.size(), input.triangles.size());
  }
}

}  // namespace
}  // namespace meshfront::testing
