#include "core/mesh/mesh_edits.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/core/mesh/mesh_shapes.h"

namespace meshfront {
namespace {

using ::testing::ElementsAre;

// The two triangles at u v, and nothing around them: w above, d below.
TEST(FlipEdge, JoinsTheCornersAcross) {
  TriangleMesh mesh;
  mesh.positions = {{-1, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, -1, 0}};
  const VertexId u(0), v(1), w(2), d(3);
  mesh.triangles = {{w, u, v}, {v, u, d}};
  FaceAdjacency adjacency = CreateAdjacency(mesh);
  FlipEdge(mesh, adjacency, 1);
  EXPECT_THAT(mesh.triangles, ElementsAre(Triangle{u, d, w}, Triangle{d, v, w}));
  EXPECT_EQ(adjacency.opposite, CreateAdjacency(mesh).opposite);
}

// Every edge of a torus and of a sheet, each for itself: who lies across is what it is of the new mesh.
TEST(FlipEdge, KeepsWhoLiesAcrossWhatSide) {
  for (TriangleMesh mesh : {shapes::Shuffled(shapes::Torus(12, 9), 1), shapes::Grid(4)}) {
    FaceAdjacency adjacency = CreateAdjacency(mesh);
    for (uint32_t h = 0; h < 3 * mesh.triangles.size(); ++h) {
      if (adjacency.OppositeOf(h) == kNoHalfEdge) continue;
      TriangleMesh flipped = mesh;
      FaceAdjacency kept = adjacency;
      FlipEdge(flipped, kept, h);
      ASSERT_EQ(kept.opposite, CreateAdjacency(flipped).opposite) << "half-edge " << h;
    }
  }
}

// A sheet with a vertex in front, one between and one at the end that nothing uses.
TEST(DropUnreferencedVertices, KeepsTheOrderOfTheOthersAndTheirAdjacency) {
  TriangleMesh mesh;
  mesh.positions = {{9, 9, 9}, {0, 0, 0}, {1, 0, 0}, {8, 8, 8}, {0, 1, 0}, {7, 7, 7}};
  mesh.normals.assign(6, {0, 0, 1});
  mesh.normals[4] = {1, 0, 0};
  mesh.triangles = {{VertexId(1), VertexId(2), VertexId(4)}};
  FaceAdjacency adjacency = CreateAdjacency(mesh);
  DropUnreferencedVertices(mesh, adjacency);
  EXPECT_THAT(mesh.positions, ElementsAre(Vec3{0, 0, 0}, Vec3{1, 0, 0}, Vec3{0, 1, 0}));
  EXPECT_THAT(mesh.normals, ElementsAre(Vec3{0, 0, 1}, Vec3{0, 0, 1}, Vec3{1, 0, 0}));
  EXPECT_THAT(mesh.triangles, ElementsAre(Triangle{VertexId(0), VertexId(1), VertexId(2)}));
  EXPECT_EQ(adjacency.outgoing, CreateAdjacency(mesh).outgoing);
}

}  // namespace
}  // namespace meshfront
