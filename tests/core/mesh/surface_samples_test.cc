// Samples of meshes: on the faces, as dense as asked for.
#include "core/mesh/surface_samples.h"

#include <algorithm>
#include <cmath>

#include "gtest/gtest.h"
#include "tests/support/shapes.h"

namespace meshfront {
namespace {

double DistanceToNearest(const TriangleMesh& points, const Vec3& x) {
  double nearest = INFINITY;
  for (const Vec3& p : points.positions) nearest = std::min(nearest, Distance(p, x));
  return nearest;
}

TEST(SampleFaces, LeavesNoGapsOnFacesThatAreLargerOrSmaller) {
  for (const TriangleMesh& cube : {testing::Cube(1), testing::Cube(60)}) {
    const TriangleMesh points = SampleFaces(cube, [](const Vec3&) { return 0.1; }).points;
    EXPECT_NEAR(static_cast<double>(points.positions.size()), 2400, 5);
    for (double u = -0.9; u < 1; u += 0.06) {
      for (double v = -0.9; v < 1; v += 0.06) EXPECT_LE(DistanceToNearest(points, {u, 1, v}), 0.18);
    }
  }
}

TEST(SampleFaces, GivesPlacesOnTheFacesWithTheirNormals) {
  const TriangleMesh points = SampleFaces(testing::Cube(3), [](const Vec3&) { return 0.2; }).points;
  for (size_t i = 0; i < points.positions.size(); ++i) {
    const Vec3 &x = points.positions[i], &n = points.normals[i];
    EXPECT_NEAR(Dot(x, n), 1, 1e-12);
    EXPECT_NEAR(std::max({std::abs(x.x), std::abs(x.y), std::abs(x.z)}), 1, 1e-12);
  }
}

TEST(SampleFaces, IsDenserWhereTheSpacingIsLess) {
  const auto spacing = [](const Vec3& x) { return x.z > 0 ? 0.05 : 0.2; };
  const TriangleMesh points = SampleFaces(testing::Icosphere(2), spacing).points;
  const auto upper =
      std::count_if(points.positions.begin(), points.positions.end(), [](const Vec3& x) { return x.z > 0; });
  const auto lower = static_cast<double>(points.positions.size()) - static_cast<double>(upper);
  EXPECT_NEAR(static_cast<double>(upper) / lower, 16, 2);
}

TEST(SampleFaces, PassesOverFacesWithoutArea) {
  TriangleMesh mesh = testing::Cube(1);
  const size_t count = SampleFaces(mesh, [](const Vec3&) { return 0.3; }).points.positions.size();
  mesh.triangles.push_back({mesh.triangles[0][0], mesh.triangles[0][0], mesh.triangles[0][1]});
  EXPECT_EQ(SampleFaces(mesh, [](const Vec3&) { return 0.3; }).points.positions.size(), count);
}

}  // namespace
}  // namespace meshfront
