// Which samples lie on which side of an edge, and what is none.
#include "core/mesh/point_pieces.h"

#include <cmath>
#include <numbers>
#include <random>

#include "tests/support/matchers.h"
#include "tests/support/shapes.h"

namespace meshfront::testing {
namespace {

constexpr double kAngle = 40 * std::numbers::pi / 180;

TriangleMesh WithDeviation(TriangleMesh points, double deviation) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> off(0, deviation);
  for (Vec3& x : points.positions) x += Vec3{off(random), off(random), off(random)};
  return points;
}

std::unique_ptr<PointPieces> PiecesOf(const TriangleMesh& points, double angle = kAngle, bool are_estimated = false) {
  auto pieces = PointPieces::Create(points.positions, points.normals, angle, are_estimated, Context{});
  EXPECT_THAT(pieces, IsOk());
  return *std::move(pieces);
}

TEST(PointPieces, AreTheFacesThatMeetAtAPlace) {
  const TriangleMesh points = Sampled(Cube(1), 4000);
  const auto pieces = PiecesOf(points);
  EXPECT_TRUE(pieces->HasEdges());
  EXPECT_EQ(pieces->SidesAt({0, 0, 1}).size(), 1u);
  EXPECT_EQ(pieces->SidesAt({0, 0.97, 0.97}).size(), 2u);
  EXPECT_EQ(pieces->SidesAt({0.97, 0.97, 0.97}).size(), 3u);
  EXPECT_TRUE(pieces->IsNearEdge({0, 0.97, 0.97}));
  EXPECT_FALSE(pieces->IsNearEdge({0, 0, 1}));
  for (const PointSide& side : pieces->SidesAt({0.97, 0.97, 0.97})) {
    for (const uint32_t i : side.members) EXPECT_NEAR(side.fit.HeightAt(points.positions[i]), 0, 1e-9);
  }
}

// Normals of planes through neighbours turn gradually at an edge.
TEST(PointPieces, SharpenNormalsThatAreBlurred) {
  TriangleMesh points = Sampled(Cube(1), 4000);
  for (size_t i = 0; i < points.positions.size(); ++i) {
    Vec3 mean;
    for (size_t j = 0; j < points.positions.size(); ++j) {
      if (SquaredDistance(points.positions[i], points.positions[j]) < 0.03) mean += points.normals[j];
    }
    points.normals[i] = Normalized(mean);
  }
  EXPECT_EQ(PiecesOf(points)->SidesAt({0, 0.97, 0.97}).size(), 1u);
  const auto pieces = PiecesOf(points, kAngle, true);
  ASSERT_EQ(pieces->SidesAt({0, 0.97, 0.97}).size(), 2u);
  EXPECT_TRUE(pieces->HasEdges());
}

TEST(PointPieces, HaveNoEdgesWhereNothingTurnsSoSharply) {
  EXPECT_FALSE(PiecesOf(Sampled(Cube(1), 3000), 95 * std::numbers::pi / 180)->HasEdges());
  EXPECT_FALSE(PiecesOf(Sampled(Icosphere(4), 3000))->HasEdges());
  EXPECT_FALSE(PiecesOf(Sampled(RoundedBox({0.8, 0.8, 0.8}, 0.2, 8, 6), 6000))->HasEdges());
}

// Edges of a few spacings: of a scan with noise they are folds, without noise they are those of a small part.
TEST(PointPieces, TakeShortEdgesInNoiseForFolds) {
  const auto noisy = [](size_t count) { return WithDeviation(Sampled(Cube(1), count), 0.1 * std::sqrt(24.0 / count)); };
  EXPECT_FALSE(PiecesOf(noisy(800))->HasEdges());
  EXPECT_TRUE(PiecesOf(noisy(8000))->HasEdges());
  EXPECT_TRUE(PiecesOf(Sampled(Cube(1), 800))->HasEdges());
}

}  // namespace
}  // namespace meshfront::testing
