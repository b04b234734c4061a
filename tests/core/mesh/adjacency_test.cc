#include "core/mesh/adjacency.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "tests/core/mesh/mesh_shapes.h"

namespace meshfront {
namespace {

using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::SizeIs;

void ExpectPartnersAreMutual(const TriangleMesh& mesh, const FaceAdjacency& adjacency) {
  for (uint32_t h = 0; h < 3 * mesh.triangles.size(); ++h) {
    const uint32_t g = adjacency.OppositeOf(h);
    if (g == kNoHalfEdge) continue;
    ASSERT_EQ(adjacency.OppositeOf(g), h);
    ASSERT_EQ(OriginOf(mesh, g), TargetOf(mesh, h));
    ASSERT_EQ(TargetOf(mesh, g), OriginOf(mesh, h));
  }
}

TEST(Adjacency, PairsEverySideOfAClosedMesh) {
  const TriangleMesh mesh = shapes::Shuffled(shapes::Torus(12, 9), 1);
  const FaceAdjacency adjacency = CreateAdjacency(mesh);
  ExpectPartnersAreMutual(mesh, adjacency);
  for (const auto& sides : adjacency.opposite) EXPECT_THAT(sides, Each(testing::Ne(kNoHalfEdge)));
  EXPECT_TRUE(HasSingleFans(mesh, adjacency));
  EXPECT_THAT(FindBoundaryLoops(adjacency), SizeIs(0));
  EXPECT_EQ(LabelComponents(adjacency).count, 1u);
}

TEST(Adjacency, StaysLinearAtAHubAndAgreesWithTheSortedPairing) {
  const TriangleMesh mesh = shapes::Shuffled(shapes::DoubleCone(20000), 2);
  const FaceAdjacency adjacency = CreateAdjacency(mesh);
  ExpectPartnersAreMutual(mesh, adjacency);
  for (const auto& sides : adjacency.opposite) ASSERT_THAT(sides, Each(testing::Ne(kNoHalfEdge)));
  EXPECT_TRUE(FindOrientedAdjacency(mesh).has_value());
}

TEST(Adjacency, CirculationFromARimVertexCoversItsFan) {
  // A square of 3 × 3 quads: 12 rim vertices, 4 inner ones.
  const TriangleMesh mesh = shapes::Shuffled(shapes::Grid(3), 3);
  const FaceAdjacency adjacency = CreateAdjacency(mesh);
  std::vector<std::set<uint32_t>> faces_at(mesh.positions.size()), walked(mesh.positions.size());
  for (uint32_t h = 0; h < 3 * mesh.triangles.size(); ++h)
    faces_at[OriginOf(mesh, h).index()].insert(FaceOfHalfEdge(h));
  int rim_vertices = 0;
  for (uint32_t v = 0; v < mesh.positions.size(); ++v) {
    rim_vertices += adjacency.IsRimVertex(v);
    uint32_t h = adjacency.outgoing[v];
    do {
      EXPECT_EQ(OriginOf(mesh, h).index(), v);
      walked[v].insert(FaceOfHalfEdge(h));
      h = adjacency.NextAroundOrigin(h);
    } while (h != kNoHalfEdge && h != adjacency.outgoing[v]);
  }
  EXPECT_EQ(rim_vertices, 12);
  EXPECT_EQ(walked, faces_at);
}

TEST(Adjacency, BoundaryLoopKeepsTheMeshOnItsLeft) {
  const TriangleMesh mesh = shapes::MeshOf({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}});
  EXPECT_THAT(FindBoundaryLoops(CreateAdjacency(mesh)), ElementsAre(ElementsAre(0, 1, 2)));
}

TEST(Adjacency, TwoSheetsThatTouchInAVertexHaveTwoLoops) {
  // Two triangles that share one vertex: two fans, two loops.
  const TriangleMesh mesh =
      shapes::MeshOf({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {-1, 0, 0}, {-1, -1, 0}}, {{0, 1, 2}, {0, 3, 4}});
  const FaceAdjacency adjacency = CreateAdjacency(mesh);
  EXPECT_THAT(FindBoundaryLoops(adjacency), ElementsAre(SizeIs(3), SizeIs(3)));
  EXPECT_FALSE(HasSingleFans(mesh, adjacency));
  EXPECT_EQ(LabelComponents(adjacency).count, 2u);
}

TEST(Adjacency, RefusesThreeFacesAtAnEdgeFlippedFacesAndRepeatedIndices) {
  const std::vector<Vec3> points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}};
  EXPECT_TRUE(FindOrientedAdjacency(shapes::MeshOf(points, {{0, 1, 2}, {1, 0, 3}})).has_value());
  EXPECT_FALSE(FindOrientedAdjacency(shapes::MeshOf(points, {{0, 1, 2}, {1, 0, 3}, {1, 0, 4}})).has_value());
  EXPECT_FALSE(FindOrientedAdjacency(shapes::MeshOf(points, {{0, 1, 2}, {0, 1, 3}})).has_value());
  EXPECT_FALSE(FindOrientedAdjacency(shapes::MeshOf(points, {{0, 1, 1}})).has_value());
}

TEST(Adjacency, UnusedVerticesHaveNoOutgoingHalfEdge) {
  const TriangleMesh mesh = shapes::MeshOf({{0, 0, 0}, {9, 9, 9}, {1, 0, 0}, {0, 1, 0}}, {{0, 2, 3}});
  EXPECT_EQ(CreateAdjacency(mesh).outgoing[1], kNoHalfEdge);
}

// A right triangle with sides 3, 5 and 4, and one with sides 1, 2, 2.
TEST(Sides, TheLongestAndTheShortestAreTheFirstOfTheirLength) {
  const TriangleMesh mesh = shapes::MeshOf(
      {{0, 0, 0}, {3, 0, 0}, {0, 4, 0}, {9, 0, 0}, {10, 0, 0}, {9.5, std::sqrt(3.75), 0}}, {{0, 1, 2}, {3, 4, 5}});
  EXPECT_EQ(SquaredLength(mesh, 1), 25);
  EXPECT_EQ(LongestSide(mesh, 0), 1u);
  EXPECT_EQ(ShortestSide(mesh, 0), 0u);
  EXPECT_EQ(LongestSide(mesh, 1), 4u);
  EXPECT_EQ(ShortestSide(mesh, 1), 3u);
}

TEST(Adjacency, HalfEdgesByEdgeGroupsEqualEdges) {
  const TriangleMesh mesh = shapes::MeshOf({{}, {}, {}, {}}, {{2, 1, 0}, {1, 2, 3}, {1, 1, 2}});
  EXPECT_THAT(HalfEdgesByEdge(mesh), ElementsAre(1, 2, 0, 3, 5, 4));
}

}  // namespace
}  // namespace meshfront
