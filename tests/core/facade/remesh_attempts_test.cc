// Rims and creases whose edges are too long for what lies close by, or make more triangles than predicted: they are divided before the
// front starts, so that the whole is made again.
#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <tuple>
#include <utility>
#include <vector>

#include "core/loose_faces.h"
#include "core/preparation.h"
#include "core/remesh.h"
#include "tests/support/checking_sink.h"
#include "tests/support/matchers.h"
#include "tests/support/shapes.h"

namespace meshfront::testing {
namespace {

using ::testing::Combine;
using ::testing::Each;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Values;

// A tube around a rod that is longer, `gap` apart: an edge along the tube's rim that subtends the angle rho would pass through the rod.
TriangleMesh RodInTube(double gap) { return Joined(OpenCylinder(1, 2, 96, 24), CappedCylinder(1 - gap, 3, 96, 32)); }

// Remeshes, and expects a whole result that is what its pieces said, without a warning but that of an input that meets itself.
absl::StatusOr<Report> RemeshWhole(TriangleMesh mesh, double rho, CheckingSink& sink, bool meets_itself = false) {
  Problem problem{std::move(mesh), {}};
  problem.options.rho = rho;
  absl::StatusOr<Report> report = Remesh(std::move(problem), sink, Context{});
  EXPECT_THAT(report, IsOk());
  if (!report.ok()) return report;
  sink.CheckEnd();
  EXPECT_THAT(sink.complaints(), IsEmpty());
  EXPECT_TRUE(report->complete);
  if (meets_itself)
    EXPECT_THAT(report->warnings, Each(HasSubstr("the input meets itself")));
  else
    EXPECT_THAT(report->warnings, IsEmpty());
  return report;
}

class TightFit : public ::testing::TestWithParam<std::tuple<double, double>> {};  // gap, rho

TEST_P(TightFit, ComesOutWhole) {
  const auto [gap, rho] = GetParam();
  CheckingSink sink;
  const absl::StatusOr<Report> report = RemeshWhole(RodInTube(gap), rho, sink);
  ASSERT_THAT(report, IsOk());
  EXPECT_THAT(sink.mesh(), IsManifold());
  EXPECT_THAT(sink.mesh(), HasComponents(2u));
  EXPECT_THAT(sink.mesh(), HasBoundaryLoops(2u));
  EXPECT_THAT(sink.mesh(), HasNoSelfIntersection());
  EXPECT_EQ(report->output.triangles, sink.mesh().triangles.size()) << "of the attempt that was kept";
  EXPECT_LT(sink.mesh().triangles.size(), 3000u) << "finer where it must be only";
}

INSTANTIATE_TEST_SUITE_P(Gaps, TightFit, Combine(Values(0.05, 0.03, 0.01), Values(1.0, 1.5)));

// How much of the result was made when the first of it was handed on.
double PartMadeAtFirst(const TriangleMesh& mesh) {
  struct FirstSink : CollectingSink {
    absl::Status Append(const MeshPiece& piece) override {
      if (this->mesh.triangles.empty()) at_first = made;
      return CollectingSink::Append(piece);
    }
    uint64_t made = 0, at_first = 0;
  } sink;
  Context context;
  context.progress = [&](const Progress& progress) { sink.made = progress.triangles; };
  Problem problem{mesh, {}};
  problem.options.sizing = Sizing::kUniform;
  problem.options.edge_length = Length{0.04, false};
  problem.options.crease_angle.reset();
  EXPECT_THAT(Remesh(std::move(problem), sink, context), IsOk());
  return static_cast<double>(sink.at_first) / static_cast<double>(sink.mesh.triangles.size());
}

// A fin of two sheets that meet at an angle of 0.02 in long edges, of which no crease is made: what comes out is held until it is
// known to fit. With a sphere beside it it is so small a part that nothing else would have it held.
TEST(Attempts, HoldWhatFoldsBack) {
  const auto finned = [](double half_width) {
    const TriangleMesh sheet = Mapped(Sheet(20), [half_width](const Vec3& p) {
      const double x = p.x < 0.05 ? p.x : p.x - 0.2, on_fin = std::max(0.0, 0.1 - std::abs(p.x - 0.1));
      return p.x > -0.05 && p.x < 0.25 ? Vec3{half_width * (p.x - 0.1) / 0.1, p.y, on_fin} : Vec3{x, p.y, 0};
    });
    return Joined(sheet, Moved(Scaled(Icosphere(4), 0.3), {3, 0, 0}));
  };
  EXPECT_LT(PartMadeAtFirst(finned(0.1)), 0.9) << "another shape is needed for this";
  EXPECT_GT(PartMadeAtFirst(finned(0.001)), 0.95);
}

// Predictions are of surfaces; what edges along creases add is found out by trying.
TEST(Attempts, BringTheCountWithinThreePercentWhereCreasesAre) {
  const TriangleMesh cylinder = CappedCylinder(1, 3, 96, 32), plate = PlateWithRoundHole(), lens = Lens(0.3);
  const std::vector<std::pair<const TriangleMesh*, uint64_t>> wishes = {
      {&cylinder, 200}, {&cylinder, 400}, {&cylinder, 3000}, {&plate, 200}, {&plate, 400}, {&lens, 200}};
  for (const auto& [shape, wanted] : wishes) {
    Problem problem{*shape, {}};
    problem.options.target_triangles = wanted;
    CollectingSink sink;
    const absl::StatusOr<Report> report = Remesh(std::move(problem), sink, Context{});
    ASSERT_THAT(report, IsOk());
    const auto count = static_cast<double>(sink.mesh.triangles.size()), target = static_cast<double>(wanted);
    EXPECT_NEAR(count, target, 0.03 * target);
    EXPECT_EQ(report->parameters.target_triangles, wanted);
    EXPECT_NEAR(static_cast<double>(report->predicted_triangles), target, 0.01 * target) << "before any was made";
  }
}

TEST(Attempts, AreTheSameBitsAtAnyThreadCount) {
  std::vector<std::vector<Vec3>> positions;
  for (const int threads : {1, 3}) {
    Problem problem{RodInTube(0.02), {}};
    problem.options.rho = 1.5;
    Context context;
    context.threads = threads;
    CollectingSink sink;
    ASSERT_THAT(Remesh(std::move(problem), sink, context), IsOk());
    positions.push_back(sink.mesh.positions);
  }
  EXPECT_EQ(positions[0], positions[1]);
}

// Noise as large as the edges: folds as thin as they are wide, at which shorter edges cut the corners as well as long ones.
class RoughGround : public ::testing::TestWithParam<std::tuple<uint64_t, double>> {};  // seed, rho

TEST_P(RoughGround, ComesOutWhole) {
  const auto [seed, rho] = GetParam();
  CheckingSink sink;
  ASSERT_THAT(RemeshWhole(WithNoise(UvSphere(24, 16), 0.16, seed), rho, sink, true), IsOk());
  EXPECT_THAT(sink.mesh(), IsClosedManifold());
  EXPECT_THAT(sink.mesh(), HasGenus(0));
}

INSTANTIATE_TEST_SUITE_P(Noise, RoughGround, Combine(Values(1u, 2u, 3u, 4u, 5u, 6u), Values(0.5, 1.0)));

// Faces cut loose are their own patches, whose loops go from corner to corner where g is longer than their sides.
TEST(LooseFaces, ArePatchesOfThreeSides) {
  const TriangleMesh sphere = Icosphere(3);
  const Vec3 place = sphere.PositionAt(VertexId(7));
  Problem problem{sphere, {}};
  problem.options.rho = 1.5;
  absl::StatusOr<Preparation> prepared = Prepare(std::move(problem), Context{});
  ASSERT_THAT(prepared, IsOk());
  ASSERT_THAT(CutFacesLoose(std::vector<Vec3>{place}, 1e-3, *prepared, Context{}), IsOk());
  ASSERT_THAT(PrepareAgain({}, std::nullopt, *prepared, Context{}), IsOk());
  EXPECT_EQ(prepared->surface->mesh().triangles.size(), sphere.triangles.size());
  ASSERT_EQ(prepared->surface->component_count(), 6u)
      << "the five faces at one of the twelve first vertices, and the rest";
  ASSERT_EQ(prepared->loops.size(), 6u);
  size_t loose = 0;
  for (const OrientedLoop& loop : prepared->loops) {
    const bool is_face =
        std::any_of(loop.points.begin(), loop.points.end(), [&](const SourcePoint& p) { return p.position == place; });
    loose += is_face;
    if (is_face) {
      EXPECT_EQ(loop.points.size(), 3u);
    }
  }
  EXPECT_EQ(loose, 5u);
  ASSERT_THAT(CutFacesLoose(std::vector<Vec3>{place}, 1e-3, *prepared, Context{}), IsOk());
  EXPECT_EQ(prepared->surface->component_count(), 6u) << "cut already";
}

// Two tents, the one on its ridge upon the other's, bent less than a crease: four faces at each edge of the ridge, which repair parts.
TEST(Seams, HaveTheSameVerticesOnBothSheets) {
  const auto tent = [](double slope) {
    return HeightField(12, [=](double x, double y) { return slope * std::abs(y) + 0.3 * x * x; });
  };
  const TriangleMesh lower = tent(-0.1), upper = Reversed(tent(0.1));
  TriangleMesh mesh = lower;
  std::vector<VertexId> names;
  for (const Vec3& p : upper.positions) {
    const auto same = std::find(lower.positions.begin(), lower.positions.end(), p);
    names.emplace_back(same == lower.positions.end() ? mesh.positions.size() : same - lower.positions.begin());
    if (same == lower.positions.end()) mesh.positions.push_back(p);
  }
  for (const Triangle& t : upper.triangles)
    mesh.triangles.push_back({names[t[0].index()], names[t[1].index()], names[t[2].index()]});
  CollectingSink sink;
  const absl::StatusOr<Report> report = Remesh(Problem{std::move(mesh), {}}, sink, Context{});
  ASSERT_THAT(report, IsOk());
  ASSERT_FALSE(report->input.repairs.empty()) << "the ridge was one";
  std::map<std::tuple<double, double, double>, int> times;
  for (const Vec3& p : sink.mesh.positions) ++times[{p.x, p.y, p.z}];
  const auto touching = std::count_if(times.begin(), times.end(), [](const auto& t) { return t.second == 2; });
  EXPECT_GE(touching, 3) << "along the ridge";
  EXPECT_THAT(sink.mesh, HasNoSelfIntersection());
}

// The shortest edge that was asked for is kept; what can't be mended then is reported.
TEST(Attempts, KeepTheShortestEdgeThatIsAllowed) {
  Problem problem{RodInTube(0.01), {}};
  problem.options.rho = 1.5;
  problem.options.min_edge = Length{1.0, false};
  CollectingSink sink;
  const absl::StatusOr<Report> report = Remesh(std::move(problem), sink, Context{});
  ASSERT_THAT(report, IsOk());
  EXPECT_FALSE(report->complete);
  EXPECT_FALSE(report->open_places.empty());
  EXPECT_LT(sink.mesh.triangles.size(), 600u);
}

}  // namespace
}  // namespace meshfront::testing
