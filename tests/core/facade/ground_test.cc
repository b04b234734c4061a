#include "core/ground.h"

#include <cmath>

#include "gtest/gtest.h"
#include "tests/support/matchers.h"
#include "tests/support/shapes.h"

namespace meshfront::testing {
namespace {

Ground Of(const TriangleMesh& mesh, double length) {
  const auto surface = MeshSurface::Create(mesh, Context{});
  const auto field = GuidanceField::Create({}, {1.2, 0, length}, Context{});
  EXPECT_THAT(surface, IsOk());
  EXPECT_THAT(field, IsOk());
  return GroundOf(**surface, *field);
}

// Two sheets of `n` squares along each side that meet in an edge, at an angle in radians.
TriangleMesh Fin(int n, double angle) {
  return Mapped(Sheet(n), [angle](const Vec3& p) {
    return Vec3{std::abs(p.x) * std::cos(angle / 2), p.y, p.x * std::sin(angle / 2)};
  });
}

TEST(Ground, FoldsBackWhereEdgesOfTheOutputRunAlongOneThatTurnsSo) {
  EXPECT_TRUE(Of(Fin(4, 0.02), 0.1).folds_back);
  EXPECT_FALSE(Of(Fin(4, 0.02), 0.4).folds_back) << "the fold's edges are as long as the output's";
  EXPECT_FALSE(Of(Fin(4, 1), 0.1).folds_back) << "a roof of 57 degrees is no fold";
  EXPECT_FALSE(Of(WavyTerrain(10), 0.01).folds_back);
}

TEST(Ground, IsRoughWhereMoreThanFewEdgesTurnSharply) {
  const auto pleated = [](int pleats) {
    return HeightField(64, [pleats](double x, double) {
      return std::lround(32 * x) % 2 != 0 && std::abs(32 * x) < 2 * pleats ? 0.2 : 0.0;
    });
  };
  EXPECT_TRUE(Of(pleated(16), 0.1).is_rough);
  EXPECT_FALSE(Of(Fin(100, 0.5), 0.1).is_rough) << "one ridge";
  EXPECT_FALSE(Of(Icosphere(3), 0.1).is_rough);
}

}  // namespace
}  // namespace meshfront::testing
