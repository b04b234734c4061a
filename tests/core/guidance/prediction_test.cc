#include "core/guidance/prediction.h"

#include <atomic>
#include <cmath>
#include <vector>

#include "gtest/gtest.h"
#include "tests/support/shapes.h"

namespace meshfront {
namespace {

FaceSpans SpansOf(const TriangleMesh& mesh) { return {mesh.positions, mesh.triangles}; }

GuidanceField FieldOf(std::vector<SizingSample> samples, double max_length) {
  return *GuidanceField::Create(std::move(samples), {1.2, 0, max_length}, {});
}

double Predict(const TriangleMesh& mesh, const GuidanceField& field, int threads = 1) {
  Context context;
  context.threads = threads;
  return *PredictTriangles(SpansOf(mesh), field, context);
}

TEST(Prediction, CountsEquilateralTrianglesOfAUniformField) {
  // A 2 × 2 sheet and edges of 0.1: 4 / (√3/4 · 0.01) triangles, on coarse faces as on fine ones.
  const double expected = kTrianglesPerIdealTriangle * 4 / (std::sqrt(3) / 4 * 0.01);
  for (int n : {1, 10, 100}) EXPECT_NEAR(Predict(testing::Sheet(n), FieldOf({}, 0.1)), expected, 1e-9 * expected);
}

TEST(Prediction, ExpectsMoreWhereTheFieldIsSteepAndFewerWhereEdgesBend) {
  EXPECT_EQ(TrianglesPerIdealTriangle(0, 0), kTrianglesPerIdealTriangle);
  EXPECT_GT(TrianglesPerIdealTriangle(0, 0.02), TrianglesPerIdealTriangle(0, 0.01));
  EXPECT_LT(TrianglesPerIdealTriangle(0.8, 0), TrianglesPerIdealTriangle(0.4, 0));
  EXPECT_EQ(TrianglesPerIdealTriangle(1e9, 0), TrianglesPerIdealTriangle(2, 0));  // no edge subtends more than 2π/3
  EXPECT_GT(TrianglesPerIdealTriangle(1e9, 0), 0);
}

TEST(Prediction, EvaluatesTheFieldBetweenTheCornersOfAFaceToo) {
  // A pit at every vertex of a sheet whose edges are as long as g: in the middle of a face g is higher by slope · distance.
  const TriangleMesh coarse = testing::Sheet(40), fine = testing::Sheet(400);
  std::vector<SizingSample> pits;
  for (const Vec3& p : coarse.positions) pits.push_back({p, 0.06});
  const GuidanceField field = FieldOf(std::move(pits), 2);
  EXPECT_NEAR(Predict(coarse, field) / Predict(fine, field), 1, 0.01);
}

TEST(Prediction, SeesASmallFeatureInsideALargeFace) {
  // One fine sample in the middle of one face of two: the same count as on a mesh that resolves it.
  const GuidanceField field = FieldOf({{{0.3, -0.4, 0}, 0.01}}, 2);
  const double fine = Predict(testing::Sheet(400), field);
  EXPECT_NEAR(Predict(testing::Sheet(1), field) / fine, 1, 0.05);
  EXPECT_NEAR(Predict(testing::Sheet(20), field) / fine, 1, 0.05);
}

TEST(Prediction, IsTheSameAtAnyThreadCount) {
  const GuidanceField field = FieldOf({{{1, 0, 0}, 0.01}, {{0, -1, 0}, 0.05}}, 0.5);
  for (const int level : {5, 6}) {
    const TriangleMesh mesh = testing::Icosphere(level);
    EXPECT_EQ(Predict(mesh, field, 1), Predict(mesh, field, 4));
  }
}

// 20,480 faces are all asked, of 81,920 a part; once where the curvature says nothing of where the triangles are, once where it does.
TEST(Prediction, TellsFromAPartOfManyFacesWhatAllTell) {
  const GuidanceField field = FieldOf({{{1, 0, 0}, 0.02}, {{0, -0.6, 0.8}, 0.05}}, 0.5);
  const TriangleMesh few = testing::Icosphere(5), many = testing::Icosphere(6);
  EXPECT_NEAR(Predict(many, field) / Predict(few, field), 1, 0.01);
  std::vector<double> curvatures;
  for (const Vec3& p : many.positions) curvatures.push_back(1 / (1.1 - p.x));
  const FaceSpans spans{many.positions, many.triangles, curvatures};
  const double bent = *PredictTriangles(spans, field, Context{});
  EXPECT_NEAR(bent / Predict(few, field), 1, 0.03);
}

// A face a thousand times as large as the others of a fine mesh counts with all of its area.
TEST(Prediction, CountsALargeFaceAmongManySmallOnesInFull) {
  TriangleMesh mesh = testing::Sheet(150);
  const uint32_t first = static_cast<uint32_t>(mesh.positions.size());
  for (const Vec3& p : {Vec3{4, 0, 0}, Vec3{8, 0, 0}, Vec3{4, 4, 0}}) mesh.positions.push_back(p);
  mesh.triangles.push_back({VertexId(first), VertexId(first + 1), VertexId(first + 2)});
  const double expected = kTrianglesPerIdealTriangle * (4 + 8) / (std::sqrt(3) / 4 * 0.01);
  EXPECT_NEAR(Predict(mesh, FieldOf({}, 0.1)), expected, 1e-3 * expected);
}

TEST(Prediction, CountsOnPlacesByTheirBendsAtAnyThreadCount) {
  std::vector<Vec3> positions;
  for (int i = 0; i < 5000; ++i) positions.push_back({0.001 * i, 0, 0});
  const std::vector<double> areas(positions.size(), 0.002), flat(positions.size(), 0), bent(positions.size(), 4);
  const GuidanceField field = FieldOf({{{1, 0, 0}, 0.01}, {{3, 0, 0}, 0.05}}, 0.5);
  Context many;
  many.threads = 4;
  for (const std::vector<double>& curvatures : {flat, bent}) {
    const PlaceSpans places{positions, areas, curvatures};
    double brute = 0;
    for (const Vec3& p : positions) {
      const double g = field.At(p);
      brute += 0.002 / (std::sqrt(3) / 4 * g * g) * TrianglesPerIdealTriangle(g * curvatures[0], 0);
    }
    const double count = *CountOnPlaces(places, field, Context{});
    EXPECT_NEAR(count, brute, 1e-9 * brute);
    EXPECT_EQ(count, *CountOnPlaces(places, field, many));
  }
}

TEST(Prediction, IsBoundedOnAFieldFarFinerThanTheFaces) {
  const double l = 1e-9;
  const double expected = kTrianglesPerIdealTriangle * 4 / (std::sqrt(3) / 4 * l * l);
  EXPECT_NEAR(Predict(testing::Sheet(2), FieldOf({}, l)) / expected, 1, 1e-9);
}

TEST(Prediction, IsZeroWithoutFaces) { EXPECT_EQ(Predict({}, FieldOf({}, 1)), 0); }

TEST(Prediction, StopsWhenItsContextSaysSo) {
  const std::atomic<bool> stop = true;
  Context context;
  context.stop = &stop;
  const TriangleMesh mesh = testing::Sheet(3);
  EXPECT_EQ(PredictTriangles(SpansOf(mesh), FieldOf({}, 1), context).status().code(), absl::StatusCode::kCancelled);
}

}  // namespace
}  // namespace meshfront
