#include "core/mesh/topology.h"

#include <gtest/gtest.h>

#include <limits>

#include "tests/core/mesh/mesh_shapes.h"

namespace meshfront {
namespace {

using shapes::MeshOf;

TEST(Topology, EmptyMeshHasNothing) {
  const TopologyReport t = MeasureTopology({});
  EXPECT_EQ(t.components, 0u);
  EXPECT_FALSE(t.closed);
  EXPECT_FALSE(t.manifold);
  EXPECT_FALSE(t.genus.has_value());
}

TEST(Topology, TetrahedronIsASphere) {
  const TopologyReport t = MeasureTopology(shapes::Tetrahedron());
  EXPECT_EQ(t.vertices, 4u);
  EXPECT_EQ(t.triangles, 4u);
  EXPECT_EQ(t.components, 1u);
  EXPECT_EQ(t.euler_characteristic, 2);
  EXPECT_EQ(t.genus, 0);
  EXPECT_TRUE(t.closed && t.manifold && t.oriented);
}

TEST(Topology, TorusHasGenusOneAlsoWhenFacesAreFlipped) {
  TriangleMesh mesh = shapes::Torus(8, 6);
  EXPECT_EQ(MeasureTopology(mesh).genus, 1);
  shapes::Reverse(mesh.triangles[5]);
  const TopologyReport t = MeasureTopology(mesh);
  EXPECT_TRUE(t.manifold && t.closed);
  EXPECT_FALSE(t.oriented);
  EXPECT_EQ(t.genus, 1);
}

TEST(Topology, ATorusWithAHoleKeepsItsGenusAndHasOneLoop) {
  TriangleMesh mesh = shapes::Torus(8, 6);
  mesh.triangles.pop_back();
  const TopologyReport t = MeasureTopology(mesh);
  EXPECT_EQ(t.genus, 1);
  EXPECT_EQ(t.boundary_loops, 1u);
  EXPECT_EQ(t.boundary_edges, 3u);
  EXPECT_FALSE(t.closed);
}

TEST(Topology, GenusIsSummedOverComponents) {
  const TopologyReport t =
      MeasureTopology(shapes::Joined(shapes::Torus(8, 6), shapes::Joined(shapes::Torus(5, 4), shapes::Grid(2))));
  EXPECT_EQ(t.components, 3u);
  EXPECT_EQ(t.genus, 2);
  EXPECT_EQ(t.boundary_loops, 1u);
}

TEST(Topology, LoopsAreFollowedInsideTheFansOfAPinchedVertex) {
  // The 4 × 4 grid without two faces that meet in one vertex only: through either fan there, one hole's rim continues
  // as the other's, so that they are one loop, as they will be once the vertex is split. The outer rim is the other
  // loop.
  TriangleMesh mesh = shapes::Grid(4);
  const VertexId centre(12);
  std::vector<size_t> at_centre;
  for (size_t f = 0; f < mesh.triangles.size(); ++f) {
    const Triangle& t = mesh.triangles[f];
    if (t[0] == centre || t[1] == centre || t[2] == centre) at_centre.push_back(f);
  }
  ASSERT_EQ(at_centre.size(), 6u);
  // The first and the last face around the centre share nothing else: they lie across from each other.
  mesh.triangles.erase(mesh.triangles.begin() + at_centre.back());
  mesh.triangles.erase(mesh.triangles.begin() + at_centre.front());
  const TopologyReport t = MeasureTopology(mesh);
  EXPECT_EQ(t.boundary_loops, 2u);
  EXPECT_EQ(t.components, 1u);
  EXPECT_FALSE(t.manifold);
  EXPECT_FALSE(t.genus.has_value());
}

TEST(Topology, BowTieIsOneComponentAndTwoLoops) {
  const TopologyReport t =
      MeasureTopology(MeshOf({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {-1, 0, 0}, {-1, -1, 0}}, {{0, 1, 2}, {0, 3, 4}}));
  EXPECT_EQ(t.components, 1u);
  EXPECT_EQ(t.boundary_loops, 2u);
  EXPECT_FALSE(t.manifold);
  EXPECT_TRUE(t.oriented);
}

TEST(Topology, ThreeFinsAtAnEdgeAreNotManifold) {
  const TopologyReport t = MeasureTopology(
      MeshOf({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}}, {{0, 1, 2}, {1, 0, 3}, {0, 1, 4}}));
  EXPECT_FALSE(t.manifold);
  EXPECT_EQ(t.boundary_edges, 6u);
  EXPECT_EQ(t.boundary_loops, 3u);  // each fin's rim ends at the edge of three
  EXPECT_FALSE(t.genus.has_value());
}

TEST(Topology, MoebiusStripIsManifoldButHasNoGenus) {
  TriangleMesh mesh;
  const int n = 9;
  for (int i = 0; i < n; ++i) mesh.positions.push_back({1.0 * i, 0, 0}), mesh.positions.push_back({1.0 * i, 1, 0});
  for (int i = 0; i < n; ++i) {
    const bool twist = i + 1 == n;
    const VertexId a(2 * i), b(2 * i + 1), c(twist ? 1 : 2 * i + 2), d(twist ? 0 : 2 * i + 3);
    mesh.triangles.push_back({a, c, b});
    mesh.triangles.push_back({c, d, b});
  }
  const TopologyReport t = MeasureTopology(mesh);
  EXPECT_TRUE(t.manifold);
  EXPECT_FALSE(t.oriented);
  EXPECT_EQ(t.boundary_loops, 1u);
  EXPECT_EQ(t.euler_characteristic, 0);
  EXPECT_FALSE(t.genus.has_value());
}

TEST(Topology, UnusableTrianglesAndUnusedVerticesDoNotCount) {
  TriangleMesh mesh = shapes::Tetrahedron();
  mesh.positions.push_back({5, 5, 5});
  mesh.positions.push_back({std::numeric_limits<double>::quiet_NaN(), 0, 0});
  mesh.triangles.push_back({VertexId(0), VertexId(4), VertexId(4)});
  mesh.triangles.push_back({VertexId(0), VertexId(1), VertexId(5)});
  const TopologyReport t = MeasureTopology(mesh);
  EXPECT_EQ(t.vertices, 4u);
  EXPECT_EQ(t.triangles, 4u);
  EXPECT_TRUE(t.closed && t.manifold && t.oriented);
}

TEST(Topology, FlippedAndOrientedMeshesGetTheSameCountsFromBothWays) {
  // A flip forces the way for any mesh; all counts but `oriented` must agree with the fast way.
  for (const TriangleMesh& mesh :
       {shapes::Torus(9, 7), shapes::Grid(6), shapes::Joined(shapes::Grid(2), shapes::Tetrahedron())}) {
    TriangleMesh flipped = shapes::Shuffled(mesh, 4);
    shapes::Reverse(flipped.triangles[3]);
    const TopologyReport a = MeasureTopology(mesh), b = MeasureTopology(flipped);
    EXPECT_EQ(a.vertices, b.vertices);
    EXPECT_EQ(a.components, b.components);
    EXPECT_EQ(a.boundary_edges, b.boundary_edges);
    EXPECT_EQ(a.boundary_loops, b.boundary_loops);
    EXPECT_EQ(a.euler_characteristic, b.euler_characteristic);
    EXPECT_EQ(a.genus, b.genus);
    EXPECT_EQ(a.manifold, b.manifold);
  }
}

}  // namespace
}  // namespace meshfront
