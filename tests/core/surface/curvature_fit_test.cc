#include "core/surface/curvature_fit.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "core/surface/vertex_normals.h"
#include "tests/support/matchers.h"
#include "tests/support/shapes.h"

namespace meshfront {
namespace {

using testing::IsOk;

std::vector<double> Curvatures(const TriangleMesh& mesh, int threads = 1) {
  Context context;
  context.threads = threads;
  auto curvatures = FitMaxCurvatures(mesh, CreateAdjacency(mesh), ComputeVertexNormals(mesh), context);
  EXPECT_THAT(curvatures, IsOk());
  return *curvatures;
}

// The curvatures of the vertices that `inside` admits, ascending.
template <class Inside>
std::vector<double> SortedCurvatures(const TriangleMesh& mesh, Inside inside) {
  const std::vector<double> all = Curvatures(mesh);
  std::vector<double> chosen;
  for (size_t v = 0; v < all.size(); ++v) {
    if (inside(mesh.positions[v])) chosen.push_back(all[v]);
  }
  std::sort(chosen.begin(), chosen.end());
  return chosen;
}
bool Everywhere(const Vec3&) { return true; }

TEST(MaxCurvatureOfQuadratic, AgreesWithTheSphereAwayFromItsTop) {
  // A unit sphere as a height field, expanded around (x0, 0): the slope is not 0, the curvature is 1 all the same.
  const double x0 = 0.6, z0 = 0.8;
  const double d = -x0 / z0, zxx = -1 / (z0 * z0 * z0), zyy = -1 / z0;
  EXPECT_NEAR(MaxCurvatureOfQuadratic(zxx / 2, 0, zyy / 2, d, 0), 1, 1e-7);
}

TEST(MaxCurvatureOfQuadratic, TakesTheLargerMagnitude) {
  EXPECT_NEAR(MaxCurvatureOfQuadratic(1, 0, -2, 0, 0), 4, 1e-12);
  EXPECT_NEAR(MaxCurvatureOfQuadratic(0, 1, 0, 0, 0), 1, 1e-12);  // a saddle along the diagonals
  EXPECT_EQ(MaxCurvatureOfQuadratic(0, 0, 0, 0.3, -0.2), 0);
}

TEST(CurvatureFit, FindsTheSpheresCurvature) {
  const auto sorted = SortedCurvatures(testing::Icosphere(4, 2.5), Everywhere);
  EXPECT_NEAR(sorted.front(), 0.4, 0.008);
  EXPECT_NEAR(sorted.back(), 0.4, 0.008);
}

TEST(CurvatureFit, FindsTheSpheresCurvatureUnderUnevenSampling) {
  // A UV sphere: needles at the poles, long rectangles at the equator.
  const auto sorted = SortedCurvatures(testing::UvSphere(80, 24), Everywhere);
  EXPECT_GT(sorted.front(), 0.93);
  EXPECT_LT(sorted.back(), 1.07);
}

TEST(CurvatureFit, FindsTheTorusTubesCurvature) {
  // Everywhere the tube's 1/0.4 is larger than the other principal curvature.
  const auto sorted = SortedCurvatures(testing::Torus(1, 0.4, 120, 48), Everywhere);
  EXPECT_NEAR(sorted.front(), 2.5, 0.15);
  EXPECT_NEAR(sorted.back(), 2.5, 0.15);
}

TEST(CurvatureFit, FindsTheCylindersCurvatureUpToItsRims) {
  const auto sorted = SortedCurvatures(testing::OpenCylinder(0.5, 3, 48, 40), Everywhere);
  EXPECT_NEAR(sorted.front(), 2, 0.1);
  EXPECT_NEAR(sorted.back(), 2, 0.1);
}

TEST(CurvatureFit, FindsTheCylindersCurvatureFromLongThinTriangles) {
  // 100 around, 10 along a length of 100: triangles 160 times as long as wide must not cap the curvature.
  const auto sorted = SortedCurvatures(testing::OpenCylinder(1, 100, 100, 10), Everywhere);
  EXPECT_NEAR(sorted[sorted.size() / 2], 1, 0.05);
}

TEST(CurvatureFit, FindsNoneInAPlane) {
  const auto sorted = SortedCurvatures(testing::Sheet(20), Everywhere);
  EXPECT_LT(sorted.back(), 1e-9);
}

TEST(CurvatureFit, FindsTheSaddlesCurvatureAtItsCentre) {
  const TriangleMesh saddle = testing::HeightField(60, [](double x, double y) { return 0.5 * (x * x - y * y); });
  const auto sorted = SortedCurvatures(saddle, [](const Vec3& p) { return Norm(p) < 0.05; });
  EXPECT_NEAR(sorted.back(), 1, 0.02);
}

TEST(CurvatureFit, StaysNearTheTruthUnderNoise) {
  // Noise of 2 % of the edge length on a sphere.
  const auto sorted = SortedCurvatures(testing::WithNoise(testing::Icosphere(4), 0.0016, 3), Everywhere);
  EXPECT_NEAR(sorted[sorted.size() / 2], 1, 0.15);
  EXPECT_LT(sorted[sorted.size() * 99 / 100], 1.6);
}

TEST(CurvatureFit, IsFiniteWhereThereIsNoFit) {
  // A tetrahedron has four vertices; a single triangle three; two vertices share a position.
  TriangleMesh tetrahedron;
  tetrahedron.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  const auto face = [](int a, int b, int c) { return Triangle{VertexId(a), VertexId(b), VertexId(c)}; };
  tetrahedron.triangles = {face(0, 2, 1), face(0, 1, 3), face(1, 2, 3), face(0, 3, 2)};
  TriangleMesh one = tetrahedron, degenerate = tetrahedron;
  one.triangles.resize(1);
  degenerate.positions[1] = degenerate.positions[0];
  for (const TriangleMesh& mesh : {tetrahedron, one, degenerate}) {
    for (const double curvature : Curvatures(mesh)) {
      EXPECT_TRUE(std::isfinite(curvature));
      EXPECT_GE(curvature, 0);
    }
  }
}

TEST(CurvatureFit, StaysBelowWhatTheMeshResolvesAtSharpCorners) {
  const TriangleMesh cube = testing::Cube(10);  // edges of 0.2
  for (const double curvature : Curvatures(cube)) EXPECT_LE(curvature, 2 / 0.2 + 1e-9);
}

TEST(CurvatureFit, CostsNoMoreAtAHubOfTenThousandTriangles) {
  const TriangleMesh wheel = testing::UvSphere(10000, 3);
  for (const double curvature : Curvatures(wheel)) EXPECT_TRUE(std::isfinite(curvature));
}

// Whether a value is the mean of some of those around, summed in their order.
bool IsMeanOfSome(double value, absl::Span<const uint32_t> ring, const std::vector<double>& all) {
  for (uint32_t some = 1; some < 1u << ring.size(); ++some) {
    double sum = 0, count = 0;
    for (size_t i = 0; i < ring.size(); ++i) {
      if (some >> i & 1) sum += all[ring[i]], ++count;
    }
    if (sum / count == value) return true;
  }
  return false;
}

// A wavy sphere: where it hardly turns from vertex to vertex most take what was fitted beside them; on a coarse one all are fitted.
TEST(CurvatureFit, FitsAPartOfTheVerticesWhereTheSurfaceHardlyTurns) {
  for (const auto& [level, least, most] : {std::tuple{6, 0.5, 0.8}, std::tuple{3, 0.0, 0.05}}) {
    const TriangleMesh mesh = testing::Mapped(
        testing::Icosphere(level), [](const Vec3& p) { return (1 + 0.05 * std::sin(5 * p.x + 3 * p.y)) * p; });
    const std::vector<double> all = Curvatures(mesh);
    const VertexRings rings = *CreateVertexRings(mesh, CreateAdjacency(mesh), Context{});
    double means = 0;
    for (uint32_t v = 0; v < all.size(); ++v) means += IsMeanOfSome(all[v], rings.Of(v), all);
    EXPECT_GE(means / static_cast<double>(all.size()), least) << level;
    EXPECT_LE(means / static_cast<double>(all.size()), most) << level;
  }
}

TEST(CurvatureFit, IsTheSameAtAnyNumberOfThreads) {
  const TriangleMesh mesh = testing::WithNoise(testing::Torus(1, 0.3, 90, 40), 0.01, 5);
  EXPECT_EQ(Curvatures(mesh, 1), Curvatures(mesh, 3));
}

TEST(CurvatureFit, ScalesWithTheInverseOfLength) {
  const TriangleMesh mesh = testing::Torus(1, 0.3, 60, 30);
  const auto one = Curvatures(mesh), small = Curvatures(testing::Scaled(mesh, 0x1p-30));
  for (size_t v = 0; v < one.size(); ++v) EXPECT_NEAR(small[v] * 0x1p-30, one[v], 1e-9);
}

TEST(CurvatureFit, StopsWhenTold) {
  std::atomic<bool> stop = true;
  Context context;
  context.stop = &stop;
  const TriangleMesh mesh = testing::Icosphere(3);
  EXPECT_THAT(FitMaxCurvatures(mesh, CreateAdjacency(mesh), ComputeVertexNormals(mesh), context),
              testing::StatusIs(absl::StatusCode::kCancelled, "cancelled"));
}

}  // namespace
}  // namespace meshfront
