#include "core/mesh/repair_slivers.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/geometry/bvh.h"
#include "tests/support/matchers.h"
#include "tests/support/slivers.h"

namespace meshfront {
namespace {

using testing::CubeWithCaps;
using testing::IsClosedManifold;
using testing::WithNeedles;

SliverChanges Mend(TriangleMesh& mesh, double reach, bool sharp = true) {
  FaceAdjacency adjacency = CreateAdjacency(mesh);
  const std::vector<bool> flags(3 * mesh.triangles.size(), sharp);
  const SliverChanges changes = MendSlivers(mesh, adjacency, flags, reach);
  const FaceAdjacency expected = CreateAdjacency(mesh);
  EXPECT_EQ(adjacency.opposite, expected.opposite);
  return changes;
}

double ThinnestAspect(const TriangleMesh& mesh, size_t* below = nullptr) {
  double thinnest = 1;
  for (const Triangle& t : mesh.triangles) {
    const Vec3 &a = mesh.PositionAt(t[0]), &b = mesh.PositionAt(t[1]), &c = mesh.PositionAt(t[2]);
    const double longest2 = std::max({SquaredDistance(a, b), SquaredDistance(b, c), SquaredDistance(c, a)});
    const double aspect = Norm(AreaVector(a, b, c)) / longest2;
    thinnest = std::min(thinnest, aspect);
    if (below != nullptr) *below += aspect < 0.1;
  }
  return thinnest;
}

// The farthest that corners, sides' middles and centroids of `mesh` are from `other`.
double Deviation(const TriangleMesh& mesh, const TriangleMesh& other) {
  const TriangleBvh bvh(other.positions, other.triangles);
  double farthest = 0;
  for (const Triangle& t : mesh.triangles) {
    const Vec3 &a = mesh.PositionAt(t[0]), &b = mesh.PositionAt(t[1]), &c = mesh.PositionAt(t[2]);
    for (const Vec3& p : {a, b, c, 0.5 * (a + b), 0.5 * (b + c), 0.5 * (c + a), (1.0 / 3) * (a + b + c)})
      farthest = std::max(farthest, Distance(p, bvh.FindClosestPoint(p, 1e9)->point.position));
  }
  return farthest;
}

TEST(MendSlivers, TurnsARowOfCapsAlongAnEdgeIntoTheFaceAcross) {
  const TriangleMesh input = CubeWithCaps(4, 1e-4);
  TriangleMesh mesh = input;
  ASSERT_LT(ThinnestAspect(mesh), 1e-3);
  const SliverChanges changes = Mend(mesh, 4e-4);
  EXPECT_EQ(changes.flipped_caps, 8u) << "one a piece of the two edges";
  EXPECT_EQ(changes.collapsed_needles, 0u);
  EXPECT_THAT(mesh, IsClosedManifold());
  EXPECT_GT(ThinnestAspect(mesh), 0.1);
  EXPECT_LT(Deviation(mesh, input), 4e-4);
  EXPECT_LT(Deviation(input, mesh), 4e-4);
}

TEST(MendSlivers, CollapsesNeedlesThatStandOnASphere) {
  const TriangleMesh input = WithNeedles(testing::Icosphere(3), 0.01, 1);
  TriangleMesh mesh = input;
  size_t before = 0, after = 0;
  ThinnestAspect(mesh, &before);
  const SliverChanges changes = Mend(mesh, 3e-3);
  EXPECT_GT(changes.collapsed_needles, 100u);
  EXPECT_THAT(mesh, IsClosedManifold());
  ThinnestAspect(mesh, &after);
  EXPECT_LT(after, before / 10) << "some are in each other's way";
  EXPECT_LT(Deviation(mesh, input), 3e-3);
  EXPECT_LT(Deviation(input, mesh), 6e-3);
}

TEST(MendSlivers, LeavesAMeshAloneWhoseSliversAreNotAtSharpEdges) {
  const TriangleMesh input = CubeWithCaps(4, 1e-4);
  TriangleMesh mesh = input;
  EXPECT_FALSE(Mend(mesh, 4e-4, false).any());
  EXPECT_EQ(mesh.triangles, input.triangles);
  EXPECT_EQ(mesh.positions, input.positions);
}

TEST(MendSlivers, MovesNothingFartherThanItsReach) {
  const TriangleMesh input = CubeWithCaps(4, 1e-3);
  TriangleMesh mesh = input;
  EXPECT_FALSE(Mend(mesh, 4e-4).any()) << "the caps are higher";
}

TEST(MendSlivers, LeavesTheWallsOfAThinSheet) {
  TriangleMesh sheet = testing::Mapped(testing::Cube(3), [](const Vec3& p) { return Vec3{p.x, p.y, 1e-4 * p.z}; });
  const TriangleMesh input = sheet;
  Mend(sheet, 4e-4);
  EXPECT_THAT(sheet, IsClosedManifold());
  EXPECT_LT(Deviation(sheet, input), 4e-4);
  EXPECT_LT(Deviation(input, sheet), 4e-4);
}

// Half of the cube is kept: the caps on its other side go alone, and each face of that half is there as it was.
TEST(MendSlivers, LeavesWhatIsKept) {
  const TriangleMesh input = CubeWithCaps(4, 1e-4);
  TriangleMesh mesh = input;
  std::vector<bool> kept;
  for (uint32_t f = 0; f < mesh.triangles.size(); ++f) {
    kept.push_back(false);
    for (const VertexId v : mesh.triangles[f]) kept.back() = kept.back() || mesh.PositionAt(v).y > 0.1;
    mesh.face_origins.push_back(f);
  }
  FaceAdjacency adjacency = CreateAdjacency(mesh);
  const std::vector<bool> flags(3 * mesh.triangles.size(), true);
  const SliverChanges changes = MendSlivers(mesh, adjacency, flags, 4e-4, kept);
  EXPECT_GT(changes.flipped_caps, 0u);
  EXPECT_LT(changes.flipped_caps, 8u);
  EXPECT_THAT(mesh, IsClosedManifold());
  size_t found = 0;
  for (size_t f = 0; f < mesh.triangles.size(); ++f) {
    const uint32_t origin = mesh.face_origins[f];
    if (!kept[origin]) continue;
    ++found;
    for (int i = 0; i < 3; ++i)
      EXPECT_EQ(mesh.PositionAt(mesh.triangles[f][i]), input.PositionAt(input.triangles[origin][i]));
  }
  EXPECT_EQ(found, static_cast<size_t>(std::count(kept.begin(), kept.end(), true)));
}

TEST(MendSlivers, ChangesNothingThatWasMended) {
  TriangleMesh mesh = CubeWithCaps(4, 1e-4);
  Mend(mesh, 4e-4);
  EXPECT_FALSE(Mend(mesh, 4e-4).any());
}

}  // namespace
}  // namespace meshfront
