// So few triangles, or such long edges, that the front finds no way over bends and thin parts: what comes out is right all the same.
#include <algorithm>
#include <cmath>
#include <string>
#include <tuple>
#include <vector>

#include "core/missed_places.h"
#include "core/preparation.h"
#include "core/remesh.h"
#include "tests/core/facade/zoo.h"
#include "tests/support/checking_sink.h"
#include "tests/support/matchers.h"
#include "tests/support/shapes.h"

namespace meshfront::testing {
namespace {

using ::testing::Combine;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Values;
using ::testing::ValuesIn;

// A ball with two thin ears: sheets whose rims bend far more than edges of a coarse mesh can follow.
TriangleMesh BallWithEars() {
  return IsoSurface(
      [](const Vec3& p) {
        const auto ear = [&](double side) {
          const Vec3 q{p.x - side * 0.6, (p.y) / 0.12, p.z - 1.4};
          return Norm({q.x / 0.35, q.y, q.z / 0.8}) - 1;
        };
        return std::min({Norm(p) - 1, ear(-1), ear(1)});
      },
      {{-1.3, -1.3, -1.3}, {1.3, 1.3, 2.5}}, 72);
}

std::vector<ZooShape> Shapes() {
  return {{"Torus", [] { return Torus(1, 0.4, 80, 32); }, 0},
          {"GenusThree", [] { return GenusThree(48); }, 0},
          {"ThinSlab", [] { return ThinSlab(30); }, 0},
          {"PlateWithRoundHole", [] { return PlateWithRoundHole(); }, 0},
          {"CappedCylinder", [] { return CappedCylinder(1, 3, 64, 24); }, 0},
          {"Star", [] { return StarPrism(7, 0.4, 0.3); }, 0},
          {"Ears", BallWithEars, 0},
          {"Cone", [] { return Pyramid(10); }, 0},
          {"Hemisphere", [] { return Hemisphere(4); }, 0},
          {"TwoSpheres", [] { return TwoSpheres(3); }, 0}};
}

// Remeshes, and expects the input's topology and nothing that meets itself.
Report RemeshRight(const TriangleMesh& input, const RemeshOptions& options) {
  CheckingSink sink;
  const absl::StatusOr<Report> report = Remesh({input, options}, sink, Context{});
  EXPECT_THAT(report, IsOk());
  if (!report.ok()) return {};
  sink.CheckEnd();
  EXPECT_THAT(sink.complaints(), IsEmpty());
  EXPECT_TRUE(report->complete);
  const TopologyReport before = MeasureTopology(input), after = MeasureTopology(sink.mesh());
  EXPECT_TRUE(after.manifold && after.oriented);
  EXPECT_EQ(after.components, before.components);
  EXPECT_EQ(after.boundary_loops, before.boundary_loops);
  EXPECT_EQ(after.genus, before.genus);
  EXPECT_THAT(sink.mesh(), HasNoSelfIntersection());
  EXPECT_EQ(report->output.triangles, after.triangles);
  EXPECT_EQ(report->output.vertices, after.vertices);
  return *report;
}

class FewTriangles : public ::testing::TestWithParam<std::tuple<ZooShape, uint64_t, Sizing>> {};

TEST_P(FewTriangles, AreAsManyAsAreWantedOrWarnedOf) {
  const auto& [shape, count, sizing] = GetParam();
  RemeshOptions options;
  options.sizing = sizing;
  options.target_triangles = count;
  const Report report = RemeshRight(shape.make(), options);
  const double off = std::abs(static_cast<double>(report.output.triangles) / static_cast<double>(count) - 1);
  const std::string both = std::to_string(report.output.triangles) + " triangles instead of the " +
                           std::to_string(count) + " of target_triangles";
  const bool is_said = std::any_of(report.warnings.begin(), report.warnings.end(),
                                   [&](const std::string& w) { return w.find(both) != std::string::npos; });
  EXPECT_EQ(is_said, off > 0.03) << report.output.triangles;
  EXPECT_LE(report.output.triangles, std::max<uint64_t>(2 * count, 150)) << "of none of these shapes more are needed";
}

INSTANTIATE_TEST_SUITE_P(Shapes, FewTriangles,
                         Combine(ValuesIn(Shapes()), Values(50u, 150u, 600u, 2000u),
                                 Values(Sizing::kAngle, Sizing::kError)),
                         [](const auto& info) {
                           return std::get<0>(info.param).name + std::to_string(std::get<1>(info.param)) +
                                  (std::get<2>(info.param) == Sizing::kAngle ? "Angle" : "Error");
                         });

class LongEdges : public ::testing::TestWithParam<ZooShape> {};

TEST_P(LongEdges, ComeOutRight) {
  RemeshOptions uniform;
  uniform.sizing = Sizing::kUniform;
  uniform.edge_length = Length{0.5, true};
  RemeshRight(GetParam().make(), uniform);
  RemeshOptions coarse;
  coarse.rho = 2.09;
  RemeshRight(GetParam().make(), coarse);
  RemeshOptions far;
  far.sizing = Sizing::kError;
  far.max_error = Length{0.1, true};
  RemeshRight(GetParam().make(), far);
}

INSTANTIATE_TEST_SUITE_P(Shapes, LongEdges, ValuesIn(Shapes()), [](const auto& info) { return info.param.name; });

// What a front leaves out may still be a mesh without any other fault.
TEST(MissedPlaces, AreWhatNoTrianglePassesOver) {
  const TriangleMesh ball = Icosphere(3), other = Moved(Icosphere(3), {5, 0, 0});
  absl::StatusOr<Preparation> prepared = Prepare(Problem{Joined(ball, other), {}}, Context{});
  ASSERT_THAT(prepared, IsOk());
  const MissedPlaces none = FindMissed(*prepared->surface, *prepared->field, Joined(ball, other));
  EXPECT_THAT(none.places, IsEmpty());
  EXPECT_THAT(none.components, IsEmpty());
  const MissedPlaces missed = FindMissed(*prepared->surface, *prepared->field, ball);
  EXPECT_THAT(missed.components, ElementsAre(1u));
  ASSERT_FALSE(missed.places.empty());
  for (const Vec3& place : missed.places) EXPECT_GT(place.x, 3);
}

// Shells much closer to each other than any edge is long, of more triangles than are held in any case.
TEST(CloseShells, AreMadeAgainWhereTheFrontMixesThemUp) {
  const TriangleMesh shells = ConcentricShells(3, 0.998);
  ASSERT_THAT(shells, HasNoSelfIntersection());
  RemeshOptions options;
  options.rho = 0.3;
  RemeshRight(shells, options);
}

}  // namespace
}  // namespace meshfront::testing
