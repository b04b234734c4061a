// Quality, distance and self-intersections.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/geometry/intersection.h"
#include "core/geometry/triangle.h"
#include "core/mesh/distance.h"
#include "core/mesh/quality.h"
#include "core/mesh/self_intersection.h"
#include "tests/core/mesh/mesh_shapes.h"
#include "tests/support/matchers.h"
#include "tests/support/shapes.h"

namespace meshfront {
namespace {

using ::testing::ElementsAre;
using ::testing::Pair;
using testing::StatusIs;

TEST(Quality, OfTwoTrianglesByHand) {
  // Equilateral of side 1 and a right isosceles one of legs 2, apart.
  const TriangleMesh mesh = shapes::MeshOf(
      {{0, 0, 0}, {1, 0, 0}, {0.5, std::sqrt(0.75), 0}, {5, 0, 0}, {7, 0, 0}, {5, 2, 0}}, {{0, 1, 2}, {3, 4, 5}});
  const QualityReport q = MeasureQuality(mesh);
  const double right = 2 * (std::sqrt(2.0) - 1);  // 2r/R of a right isosceles triangle
  EXPECT_EQ(q.triangles, 2u);
  EXPECT_NEAR(q.radius_ratio_min, right, 1e-14);
  EXPECT_NEAR(q.radius_ratio_p0_5, right + 0.005 * (1 - right), 1e-14);
  EXPECT_NEAR(q.radius_ratio_median, (1 + right) / 2, 1e-14);
  EXPECT_NEAR(q.radius_ratio_mean, (1 + right) / 2, 1e-14);
  EXPECT_NEAR(q.min_angle_deg, 45, 1e-12);
  EXPECT_EQ(q.share_min_angle_below_30, 0);
  EXPECT_NEAR(q.incident_edge_ratio_max, std::sqrt(2.0), 1e-14);
  EXPECT_NEAR(q.edge_length_min, 1, 1e-15);
  EXPECT_NEAR(q.edge_length_median, 1.5, 1e-15);
  EXPECT_NEAR(q.edge_length_max, std::sqrt(8.0), 1e-14);
  EXPECT_TRUE(q.valence_histogram.empty());
}

TEST(Quality, ValenceOfAnIcosphereIsFiveAtTwelveVertices) {
  const QualityReport q = MeasureQuality(testing::Icosphere(2));
  EXPECT_THAT(q.valence_histogram, ElementsAre(0, 0, 0, 0, 0, 12, 150));
}

TEST(Quality, EmptyAndDegenerateMeshesHaveZeros) {
  EXPECT_EQ(MeasureQuality({}).triangles, 0u);
  EXPECT_EQ(QualityAccumulator().Report().triangles, 0u);
  const QualityReport q = MeasureQuality(shapes::MeshOf({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, {{0, 1, 2}, {0, 0, 1}}));
  EXPECT_EQ(q.triangles, 2u);
  EXPECT_EQ(q.radius_ratio_min, 0);
  EXPECT_EQ(q.min_angle_deg, 0);
  EXPECT_EQ(q.share_min_angle_below_30, 1);
}

TEST(Quality, AccumulatorAgreesWithTheWholeMesh) {
  for (const TriangleMesh& mesh : {testing::GenusThree(32), testing::Icosphere(3), shapes::Grid(4)}) {
    QualityAccumulator accumulator;
    for (const Triangle& t : mesh.triangles)
      accumulator.Add(mesh.PositionAt(t[0]), mesh.PositionAt(t[1]), mesh.PositionAt(t[2]));
    const QualityReport a = accumulator.Report(), b = MeasureQuality(mesh);
    EXPECT_EQ(a.triangles, b.triangles);
    EXPECT_EQ(a.radius_ratio_min, b.radius_ratio_min);
    EXPECT_NEAR(a.radius_ratio_p0_5, b.radius_ratio_p0_5, 2e-3);
    EXPECT_NEAR(a.radius_ratio_median, b.radius_ratio_median, 1e-3);
    EXPECT_EQ(a.radius_ratio_mean, b.radius_ratio_mean);
    EXPECT_EQ(a.min_angle_deg, b.min_angle_deg);
    EXPECT_EQ(a.share_min_angle_below_30, b.share_min_angle_below_30);
  }
}

TEST(Quality, SmallestAngleIsThatOfTheTriangles) {
  const TriangleMesh mesh = testing::WithNoise(testing::Icosphere(2), 0.05, 5);
  double smallest = 10;
  for (const Triangle& t : mesh.triangles) {
    smallest = std::min(smallest, MinAngle(mesh.PositionAt(t[0]), mesh.PositionAt(t[1]), mesh.PositionAt(t[2])));
  }
  EXPECT_NEAR(MeasureQuality(mesh).min_angle_deg, smallest * 180 / std::numbers::pi, 1e-9);
}

TEST(Distance, OfAMeshToItselfIsZero) {
  const TriangleMesh mesh = testing::Icosphere(2);
  const auto report = MeasureDistance(mesh, mesh, {.samples = 5000}, Context{});
  ASSERT_TRUE(report.ok());
  EXPECT_LT(report->SymmetricMax(), 1e-15);
}

TEST(Distance, OfTwoParallelSheetsIsTheirGap) {
  // A sheet of side 2 and a smaller one of side 1 above its middle, 0.25 apart. Backward: up to the corners.
  TriangleMesh below = testing::Sheet(4), above = testing::Mapped(below, [](const Vec3&p) {
                                            return Vec3{p.x / 2, p.y / 2, 0.25};
                                          });
  const auto report = MeasureDistance(above, below, {.samples = 20000}, Context{});
  ASSERT_TRUE(report.ok());
  EXPECT_DOUBLE_EQ(report->forward.max, 0.25);
  EXPECT_NEAR(report->forward.mean, 0.25, 1e-12);
  EXPECT_NEAR(report->forward.rms, 0.25, 1e-12);
  EXPECT_DOUBLE_EQ(report->backward.max, std::sqrt(0.5 + 0.0625));  // at a corner of the large sheet, a vertex
  EXPECT_EQ(std::abs(report->backward.max_at.x), 1);
  EXPECT_NEAR(report->Percent(report->forward.max), 100 * 0.25 / std::sqrt(8.0), 1e-12);
}

TEST(Distance, SeesAHoleOnlyFromTheWholeSide) {
  TriangleMesh whole = testing::Icosphere(3), holed = whole;
  std::erase_if(holed.triangles, [&](const Triangle& t) { return whole.PositionAt(t[0]).z > 0.8; });
  const auto report = MeasureDistance(holed, whole, {.samples = 20000}, Context{});
  EXPECT_LT(report->forward.max, 1e-15);
  EXPECT_GT(report->backward.max, 0.4);
}

TEST(Distance, IsTheSameAtAnyNumberOfThreadsAndChangesWithTheSeed) {
  const TriangleMesh a = testing::Icosphere(2), b = testing::Icosphere(4);
  Context one, many;
  many.threads = 4;
  const auto x = MeasureDistance(a, b, {.samples = 20000}, one), y = MeasureDistance(a, b, {.samples = 20000}, many);
  EXPECT_EQ(x->forward.rms, y->forward.rms);
  EXPECT_EQ(x->backward.mean, y->backward.mean);
  EXPECT_EQ(x->backward.max, y->backward.max);
  EXPECT_EQ(x->forward.max_at, y->forward.max_at);
  EXPECT_NE(x->forward.rms, MeasureDistance(a, b, {.samples = 20000, .seed = 2}, one)->forward.rms);
}

TEST(Distance, RefusesMeshesWithoutTriangles) {
  EXPECT_THAT(MeasureDistance({}, shapes::Tetrahedron(), {}, Context{}),
              StatusIs(absl::StatusCode::kInvalidArgument, "the mesh has no"));
  EXPECT_THAT(MeasureDistance(shapes::Tetrahedron(), {}, {}, Context{}),
              StatusIs(absl::StatusCode::kInvalidArgument, "the reference has no"));
}

uint64_t PairsOf(const TriangleMesh& mesh) { return FindSelfIntersections(mesh, 10, Context{})->pairs; }

TEST(SelfIntersections, CleanShapesHaveNone) {
  EXPECT_EQ(PairsOf(testing::Icosphere(3)), 0u);
  EXPECT_EQ(PairsOf(testing::ThinSlab(20)), 0u);
  EXPECT_EQ(PairsOf(testing::Cube(3)), 0u);
  EXPECT_EQ(PairsOf(testing::Soup(testing::Icosphere(2))), 0u);  // corners at equal positions are shared
  EXPECT_EQ(PairsOf({}), 0u);
}

TEST(SelfIntersections, ListsThePairsInOrder) {
  // Two triangles crossing a third, and a duplicate of the third.
  const TriangleMesh mesh = shapes::MeshOf(
      {{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {1, 1, -1}, {1, 1, 1}, {3, 3, 0}, {9, 9, 9}, {9, 9, 8}, {9, 8, 9}},
      {{0, 1, 2}, {6, 7, 8}, {3, 4, 5}, {1, 0, 2}});
  const auto found = FindSelfIntersections(mesh, 2, Context{});
  ASSERT_TRUE(found.ok());
  EXPECT_EQ(found->pairs, 3u);
  EXPECT_THAT(found->first_pairs, ElementsAre(Pair(FaceId(0), FaceId(2)), Pair(FaceId(0), FaceId(3))));
}

TEST(SelfIntersections, EqualBruteForceOnCrossingSpheresAtAnyNumberOfThreads) {
  const TriangleMesh mesh = shapes::Joined(testing::Icosphere(2), testing::Icosphere(2), {0.7, 0.1, 0.05});
  const auto corners = [&](size_t f, Vec3(&out)[3]) {
    for (int i = 0; i < 3; ++i) out[i] = mesh.PositionAt(mesh.triangles[f][i]);
  };
  std::vector<std::pair<FaceId, FaceId>> expected;
  for (size_t f = 0; f < mesh.triangles.size(); ++f) {
    for (size_t g = f + 1; g < mesh.triangles.size(); ++g) {
      Vec3 a[3], b[3];
      corners(f, a), corners(g, b);
      if (TrianglesIntersect(a, b, SharedCornersOf(mesh.triangles[f], mesh.triangles[g])))
        expected.push_back({FaceId(f), FaceId(g)});
    }
  }
  EXPECT_GT(expected.size(), 20u);
  Context many;
  many.threads = 3;
  EXPECT_EQ(FindSelfIntersections(mesh, 10000, many)->first_pairs, expected);
  EXPECT_EQ(PairsOf(mesh), expected.size());
}

TEST(SelfIntersections, DegenerateFacesAreSkippedAndCounted) {
  TriangleMesh mesh = shapes::Tetrahedron();
  mesh.triangles.push_back({VertexId(0), VertexId(0), VertexId(1)});
  mesh.positions.push_back({0.5, 0, 0});
  mesh.triangles.push_back({VertexId(0), VertexId(4), VertexId(1)});
  const auto found = FindSelfIntersections(mesh, 10, Context{});
  EXPECT_EQ(found->pairs, 0u);
  EXPECT_EQ(found->skipped_faces, 2u);
}

}  // namespace
}  // namespace meshfront
