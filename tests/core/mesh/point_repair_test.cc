// What becomes of points that are no samples, and normals of those that have none.
#include "core/mesh/point_repair.h"

#include <cmath>
#include <limits>
#include <map>

#include "tests/support/matchers.h"
#include "tests/support/shapes.h"

namespace meshfront {
namespace {

using testing::IsOk;
using testing::StatusIs;

std::map<std::string, uint64_t> ActionsOf(const PointRepair& repair) {
  std::map<std::string, uint64_t> counts;
  for (const RepairAction& action : repair.actions) counts[action.what] = action.count;
  return counts;
}

TEST(RepairPoints, LeavesGoodOnesAlone) {
  const TriangleMesh points = testing::Sampled(testing::Icosphere(3), 3000);
  const auto repaired = RepairPoints(points, true, Context{});
  ASSERT_THAT(repaired, IsOk());
  EXPECT_TRUE(repaired->actions.empty());
  EXPECT_EQ(repaired->points.positions, points.positions);
  EXPECT_EQ(repaired->points.normals, points.normals);
}

TEST(RepairPoints, DropsAndCountsWhatIsNoSample) {
  TriangleMesh points = testing::Sampled(testing::Icosphere(3), 3000);
  const size_t good = points.positions.size();
  for (const Vec3& x : {Vec3{NAN, 0, 0}, Vec3{1e200, 0, 0}, points.positions[5], points.positions[5], Vec3{1.7, 0, 0}})
    points.positions.push_back(x), points.normals.push_back({1, 0, 0});
  const auto repaired = RepairPoints(points, true, Context{});
  ASSERT_THAT(repaired, IsOk());
  EXPECT_EQ(repaired->points.positions.size(), good);
  const std::map<std::string, uint64_t> expected = {
      {"dropped_duplicate_points", 2}, {"dropped_non_finite_points", 2}, {"dropped_outliers", 1}};
  EXPECT_EQ(ActionsOf(*repaired), expected);
  EXPECT_THAT(RepairPoints(points, false, Context{}),
              StatusIs(absl::StatusCode::kFailedPrecondition, "dropped_non_finite_points"));
}

TEST(RepairPoints, RefusesTooFew) {
  TriangleMesh points;
  points.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  EXPECT_THAT(RepairPoints(points, true, Context{}), StatusIs(absl::StatusCode::kInvalidArgument, "at least 4"));
}

TEST(RepairPoints, EstimatesNormalsOutwardOnEveryPart) {
  for (const TriangleMesh& shape : {testing::TwoSpheres(4), testing::Torus(1, 0.4, 60, 24), testing::GenusThree(48)}) {
    TriangleMesh points = testing::Sampled(shape, 8000);
    const std::vector<Vec3> normals = std::exchange(points.normals, {});
    const auto repaired = RepairPoints(points, true, Context{});
    ASSERT_THAT(repaired, IsOk());
    EXPECT_EQ(ActionsOf(*repaired)["estimated_normals"], 8000u);
    EXPECT_EQ(repaired->undecided_pairs, 0u);
    for (size_t i = 0; i < normals.size(); ++i) EXPECT_GT(Dot(normals[i], repaired->points.normals[i]), 0.6) << i;
  }
}

TEST(RepairPoints, TakesTheSideOfNormalsThatAreThere) {
  TriangleMesh points = testing::Sampled(testing::Icosphere(4), 4000);
  for (size_t i = 0; i < points.normals.size(); ++i) points.normals[i] = i % 3 == 0 ? -points.normals[i] : Vec3{};
  const auto repaired = RepairPoints(points, true, Context{});
  ASSERT_THAT(repaired, IsOk());
  for (size_t i = 0; i < 4000; ++i) EXPECT_LT(Dot(points.positions[i], repaired->points.normals[i]), 0);
}

TEST(RepairPoints, TurnsNormalsToTheSideOfMost) {
  TriangleMesh points = testing::Sampled(testing::Torus(1, 0.4, 60, 24), 6000);
  const std::vector<Vec3> normals = points.normals;
  uint64_t turned = 0;
  for (size_t i = 0; i < 6000; ++i) {
    if (i % 5 == 0 || points.positions[i].x > 0.9) points.normals[i] = -points.normals[i], ++turned;
  }
  const auto repaired = RepairPoints(points, true, Context{});
  ASSERT_THAT(repaired, IsOk());
  EXPECT_EQ(ActionsOf(*repaired)["turned_normals"], turned);
  EXPECT_EQ(repaired->points.normals, normals);
  const auto left_alone = RepairPoints(points, false, Context{});
  ASSERT_THAT(left_alone, IsOk());
  EXPECT_EQ(left_alone->points.normals, points.normals);
}

// Sheets a spacing apart, whose cosines say that they are on opposite sides.
TEST(RepairPoints, KeepsTheSidesOfThinPlatesApart) {
  const TriangleMesh points = testing::Sampled(testing::ThinSlab(40, 0.02), 40000);
  EXPECT_THAT(RepairPoints(points, true, Context{})->actions, ::testing::IsEmpty());
}

// A Möbius band has one side.
TEST(RepairPoints, SaysWhereSidesAreNotClear) {
  TriangleMesh points;
  for (int i = 0; i < 200; ++i) {
    for (int j = 0; j < 9; ++j) {
      const double a = 2 * M_PI * i / 200, r = 1 + 0.03 * (j - 4) * std::cos(0.5 * a);
      points.positions.push_back({r * std::cos(a), r * std::sin(a), 0.03 * (j - 4) * std::sin(0.5 * a)});
    }
  }
  const auto repaired = RepairPoints(points, true, Context{});
  ASSERT_THAT(repaired, IsOk());
  EXPECT_GT(repaired->undecided_pairs, 0u);
}

TEST(RepairPoints, RefusesLinesAndVolumes) {
  TriangleMesh line, volume = testing::Sampled(testing::Icosphere(3), 4000);
  for (int i = 0; i < 100; ++i) line.positions.push_back({0.1 * i, 0.3 * i, 1 - 0.2 * i});
  EXPECT_THAT(RepairPoints(line, true, Context{}), StatusIs(absl::StatusCode::kFailedPrecondition, "on a line"));
  for (size_t i = 0; i < volume.positions.size(); ++i)
    volume.positions[i] *= std::cbrt(std::fmod(0.618 * static_cast<double>(i), 1.0));
  volume.normals.clear();
  EXPECT_THAT(RepairPoints(volume, true, Context{}), StatusIs(absl::StatusCode::kFailedPrecondition, "volume"));
}

}  // namespace
}  // namespace meshfront
