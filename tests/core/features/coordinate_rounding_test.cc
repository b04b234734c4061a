#include "core/features/coordinate_rounding.h"

#include <cmath>
#include <limits>

#include "gtest/gtest.h"
#include "tests/support/rounded_shapes.h"
#include "tests/support/shapes.h"

namespace meshfront {
namespace {

// A ball far from the origin along x alone, its coordinates written by a format and read again.
TriangleMesh BallWrittenAs(const char* format) {
  return testing::AsWritten(testing::Mapped(testing::Icosphere(3),
                                            [](const Vec3& p) {
                                              return Vec3{p.x + 1000, p.y, 0.01 * p.z};
                                            }),
                            format);
}

TEST(CoordinateRounding, KnowsSignificantDigits) {
  const CoordinateRounding rounding(BallWrittenAs("%.6g"));
  EXPECT_DOUBLE_EQ(rounding.SpacingAt(1000.5), 1e-2);
  EXPECT_DOUBLE_EQ(rounding.SpacingAt(-999.5), 1e-3);
  EXPECT_DOUBLE_EQ(rounding.SpacingAt(0.5), 1e-6);
  EXPECT_LE(rounding.SpacingAt(0.005), 1e-8);
}

TEST(CoordinateRounding, KnowsDigitsBehindThePoint) {
  const CoordinateRounding rounding(BallWrittenAs("%.4f"));
  for (const double x : {1000.5, 0.5, 0.005, 0.0}) EXPECT_DOUBLE_EQ(rounding.SpacingAt(x), 1e-4) << x;
}

TEST(CoordinateRounding, KnowsFloatsAlsoInATextOfThem) {
  const TriangleMesh floats = testing::AsFloats(BallWrittenAs("%.17g"));
  const CoordinateRounding binary(floats);
  EXPECT_DOUBLE_EQ(binary.SpacingAt(1000.5), std::ldexp(1, -14));
  EXPECT_DOUBLE_EQ(binary.SpacingAt(-0.6), std::ldexp(1, -24));
  const CoordinateRounding text(testing::AsWritten(floats, "%.9g"));
  EXPECT_DOUBLE_EQ(text.SpacingAt(1000.5), std::ldexp(1, -14));
}

TEST(CoordinateRounding, IsNoneOfNumbersThatAreNotRounded) {
  const CoordinateRounding rounding(BallWrittenAs("%.17g"));
  EXPECT_EQ(rounding.SpacingAt(1000.5), 0);
  EXPECT_EQ(CoordinateRounding(TriangleMesh()).SpacingAt(1), 0);
}

// Eight spacings and less to an edge: nobody rounds a shape so, but it may have been drawn on a grid.
TEST(CoordinateRounding, IsThatOfFloatsOnAGridOfWholeNumbers) {
  const TriangleMesh grid = testing::Mapped(testing::Sheet(20), [](const Vec3& p) {
    return Vec3{std::round(10 * p.x), std::round(10 * p.y), std::abs(p.x) < 0.11 ? 1.0 : 0.0};
  });
  EXPECT_LT(CoordinateRounding(grid).SpacingAt(7), 1e-5);
  EXPECT_LT(CoordinateRounding(testing::Scaled(grid, 1e3)).SpacingAt(7000), 1e-2);
  EXPECT_GT(CoordinateRounding(testing::AsWritten(testing::Icosphere(3), "%.3f")).SpacingAt(0.5), 0);
}

TEST(CoordinateRounding, PassesOverAFewNumbersThatCameLater) {
  TriangleMesh ball = BallWrittenAs("%.6g");
  for (const size_t v : {size_t{7}, size_t{70}}) ball.positions[v] = ball.positions[v] * (1 + 1e-10);
  EXPECT_DOUBLE_EQ(CoordinateRounding(ball).SpacingAt(1000.5), 1e-2);
}

// A face that is 0.1 high, in the plane of x and y: what x and y are makes no difference.
TEST(CoordinateRounding, TurnsFacesByWhatLiesAlongTheirNormals) {
  TriangleMesh mesh = BallWrittenAs("%.6g");
  const auto first = static_cast<uint32_t>(mesh.positions.size());
  for (const Vec3& p : {Vec3{1000, 0, 0.5}, {1000.2, 0, 0.5}, {1000.1, 0.1, 0.5}}) mesh.positions.push_back(p);
  mesh.triangles.push_back({VertexId(first), VertexId(first + 1), VertexId(first + 2)});
  const auto face = static_cast<uint32_t>(mesh.triangles.size() - 1);
  const CoordinateRounding rounding(mesh);
  EXPECT_NEAR(rounding.TiltOf(mesh, face, {0, 0, 1}), 1e-6 / 0.1, 1e-9);
  EXPECT_GT(rounding.TiltOf(mesh, face, {1, 0, 0}), 0.01);
  mesh.triangles.back()[2] = VertexId(first);
  EXPECT_EQ(rounding.TiltOf(mesh, face, {0, 0, 1}), std::numeric_limits<double>::infinity());
}

}  // namespace
}  // namespace meshfront
