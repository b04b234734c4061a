#include "core/mesh/repair.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "tests/core/mesh/mesh_shapes.h"
#include "tests/support/matchers.h"
#include "tests/support/shapes.h"

namespace meshfront {
namespace {

using testing::HasBoundaryLoops;
using testing::HasComponents;
using testing::HasGenus;
using testing::IsClosedManifold;
using ::testing::IsEmpty;
using testing::IsManifold;
using testing::StatusIs;

uint64_t CountOf(const RepairResult& result, const std::string& what) {
  for (const RepairAction& action : result.actions) {
    if (action.what == what) return action.count;
  }
  return 0;
}

std::string Told(const RepairResult& result) {
  std::string text;
  for (const RepairAction& action : result.actions) text += action.what + " " + std::to_string(action.count) + "; ";
  return text;
}

// The result of a repair that must succeed; it must be an oriented manifold that a second repair leaves alone.
RepairResult Repaired(const TriangleMesh& mesh) {
  absl::StatusOr<RepairResult> result = RepairMesh(mesh, Context{});
  EXPECT_TRUE(result.ok()) << result.status();
  if (!result.ok()) return {};
  EXPECT_THAT(result->mesh, IsManifold()) << Told(*result);
  EXPECT_EQ(MeasureTopology(result->mesh).vertices, result->mesh.positions.size());
  EXPECT_TRUE(RequireManifold(result->mesh).ok()) << RequireManifold(result->mesh);
  absl::StatusOr<RepairResult> again = RepairMesh(result->mesh, Context{});
  EXPECT_TRUE(again.ok()) << again.status();
  EXPECT_EQ(Told(*again), "") << "after " << Told(*result);
  EXPECT_EQ(again->mesh.positions, result->mesh.positions);
  EXPECT_EQ(again->mesh.triangles, result->mesh.triangles);
  return *std::move(result);
}

TEST(Repair, LeavesACleanMeshAloneBitForBit) {
  for (const TriangleMesh& mesh : {shapes::Torus(9, 7), shapes::Grid(5), testing::Icosphere(2),
                                   testing::ConcentricShells(2), testing::ThinSlab(10), testing::DiskWithHoles(30, 3),
                                   shapes::DoubleCone(3000), testing::Permuted(testing::Icosphere(2), 3)}) {
    const RepairResult result = Repaired(mesh);
    EXPECT_THAT(result.actions, IsEmpty()) << Told(result);
    EXPECT_EQ(result.mesh.positions, mesh.positions);
    EXPECT_EQ(result.mesh.triangles, mesh.triangles);
  }
}

TEST(Repair, CountsTheComponents) {
  EXPECT_EQ(RepairMesh(testing::Cube(1), Context{})->components, 1u);
  EXPECT_EQ(RepairMesh(testing::ConcentricShells(2, 0.5), Context{})->components, 2u);
}

TEST(Repair, DropsUnreferencedVerticesAndTheirNormals) {
  TriangleMesh mesh = shapes::Tetrahedron();
  mesh.positions.insert(mesh.positions.begin(), Vec3{9, 9, 9});
  for (Triangle& t : mesh.triangles)
    t = {VertexId(t[0].index() + 1), VertexId(t[1].index() + 1), VertexId(t[2].index() + 1)};
  for (int i = 0; i < 5; ++i) mesh.normals.push_back({double(i), 0, 0});
  const RepairResult result = Repaired(mesh);
  EXPECT_EQ(CountOf(result, "unreferenced_vertices"), 1u);
  EXPECT_EQ(result.mesh.positions.size(), 4u);
  EXPECT_EQ(result.mesh.normals, (std::vector<Vec3>{{1, 0, 0}, {2, 0, 0}, {3, 0, 0}, {4, 0, 0}}));
  EXPECT_TRUE(RequireManifold(mesh).ok());
}

TEST(Repair, DropsFacesWithRepeatedIndicesAndDuplicates) {
  TriangleMesh mesh = shapes::Torus(8, 6);
  mesh.triangles.push_back({VertexId(1), VertexId(1), VertexId(2)});
  mesh.triangles.push_back({VertexId(3), VertexId(3), VertexId(3)});
  Triangle reversed = mesh.triangles[7];
  shapes::Reverse(reversed);
  mesh.triangles.push_back(mesh.triangles[4]);
  mesh.triangles.push_back(reversed);
  EXPECT_THAT(RequireManifold(mesh), StatusIs(absl::StatusCode::kFailedPrecondition, "names a vertex twice"));
  const RepairResult result = Repaired(mesh);
  EXPECT_EQ(CountOf(result, "dropped_degenerate_faces"), 2u);
  EXPECT_EQ(CountOf(result, "dropped_duplicate_faces"), 2u);
  EXPECT_EQ(result.mesh.triangles, shapes::Torus(8, 6).triangles);
}

// Two faces back to back that hang on an edge of a torus, as decimation leaves them.
TEST(Repair, DropsAFlapOfNoThickness) {
  TriangleMesh mesh = shapes::Torus(8, 6);
  const Triangle at = mesh.triangles[7];
  const VertexId tip(mesh.positions.size());
  mesh.positions.push_back(1.1 * mesh.PositionAt(at[0]));
  mesh.triangles.push_back({at[0], at[1], tip});
  mesh.triangles.push_back({at[1], at[0], tip});
  const RepairResult result = Repaired(mesh);
  EXPECT_EQ(CountOf(result, "dropped_duplicate_faces"), 2u);
  EXPECT_EQ(CountOf(result, "split_non_manifold_edges"), 0u);
  EXPECT_EQ(result.mesh.triangles, shapes::Torus(8, 6).triangles);
  mesh.triangles.pop_back();
  EXPECT_EQ(Repaired(mesh).mesh.triangles.size(), mesh.triangles.size()) << "a single face was meant";
}

TEST(Repair, DropsFacesWithCornersThatAreNotFiniteOrHuge) {
  TriangleMesh mesh = shapes::Grid(8);
  mesh.positions[40].x = std::numeric_limits<double>::quiet_NaN();  // the middle one, with six faces
  mesh.positions[0].y = 1e200;                                      // a corner with two
  EXPECT_THAT(RequireManifold(mesh), StatusIs(absl::StatusCode::kFailedPrecondition, "8 defects, the first: "));
  const RepairResult result = Repaired(mesh);
  EXPECT_EQ(CountOf(result, "dropped_non_finite_faces"), 6u);
  EXPECT_EQ(CountOf(result, "dropped_huge_faces"), 2u);
  EXPECT_THAT(result.mesh, HasBoundaryLoops(2));
}

TEST(Repair, OrientsEveryThirdFaceBack) {
  TriangleMesh mesh = testing::Icosphere(2);
  for (size_t f = 0; f < mesh.triangles.size(); f += 3) shapes::Reverse(mesh.triangles[f]);
  EXPECT_THAT(RequireManifold(mesh), StatusIs(absl::StatusCode::kFailedPrecondition, "in the same direction"));
  const RepairResult result = Repaired(mesh);
  EXPECT_EQ(CountOf(result, "reversed_faces"), (mesh.triangles.size() + 2) / 3);
  EXPECT_THAT(result.mesh, IsClosedManifold());
}

TEST(Repair, TurnsAnInsideOutSphereButNotACavity) {
  EXPECT_EQ(CountOf(Repaired(testing::Reversed(testing::Icosphere(2))), "reversed_components"), 1u);
  EXPECT_EQ(Told(Repaired(testing::ConcentricShells(2))), "");
  // The whole nest inside out: the outer shell and its cavity are both turned.
  const RepairResult nest = Repaired(testing::Reversed(testing::ConcentricShells(2)));
  EXPECT_EQ(CountOf(nest, "reversed_components"), 2u);
  // Two spheres side by side, one inside out.
  EXPECT_EQ(
      CountOf(Repaired(shapes::Joined(testing::Icosphere(1), testing::Reversed(testing::Icosphere(1)), {3, 0, 0})),
              "reversed_components"),
      1u);
}

TEST(Repair, SplitsABowTieIntoTwoVertices) {
  const TriangleMesh mesh =
      shapes::MeshOf({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {-1, 0, 0}, {-1, -1, 0}}, {{0, 1, 2}, {0, 3, 4}});
  EXPECT_THAT(RequireManifold(mesh),
              StatusIs(absl::StatusCode::kFailedPrecondition, "vertex 0 at (0, 0, 0) joins separate fans"));
  const RepairResult result = Repaired(mesh);
  EXPECT_EQ(CountOf(result, "split_non_manifold_vertices"), 1u);
  EXPECT_THAT(result.mesh, HasComponents(2));
}

TEST(Repair, SplitsTwoSpheresThatShareAVertex) {
  TriangleMesh mesh = shapes::Joined(testing::Icosphere(1), testing::Icosphere(1), {2, 0, 0});
  // Any vertex of the first stands for any of the second.
  const VertexId kept(0), gone(testing::Icosphere(1).positions.size());
  for (Triangle& t : mesh.triangles) {
    for (VertexId& v : t) {
      if (v == gone) v = kept;
    }
  }
  const RepairResult result = Repaired(mesh);
  EXPECT_THAT(result.mesh, IsClosedManifold());
  EXPECT_THAT(result.mesh, HasComponents(2));
}

TEST(Repair, TakesTheFinOffASheet) {
  // Two coplanar triangles and a third upright on their common edge, on either side and in either direction.
  for (const double z : {1.0, -1.0}) {
    for (const bool turned : {false, true}) {
      TriangleMesh mesh = shapes::MeshOf({{0, 0, 0}, {1, 0, 0}, {0.5, 1, 0}, {0.5, -1, 0}, {0.5, 0, z}},
                                         {{0, 1, 2}, {1, 0, 3}, {0, 1, 4}});
      if (turned) shapes::Reverse(mesh.triangles[2]);
      EXPECT_THAT(RequireManifold(mesh), StatusIs(absl::StatusCode::kFailedPrecondition, "has 3 triangles (0, 1, 2)"));
      const RepairResult result = Repaired(mesh);
      EXPECT_EQ(CountOf(result, "split_non_manifold_edges"), 1u);
      EXPECT_THAT(result.mesh, HasComponents(2));
      EXPECT_EQ(result.mesh.triangles[0], mesh.triangles[0]);
      EXPECT_EQ(result.mesh.triangles[1], mesh.triangles[1]);
    }
  }
}

TriangleMesh UnitCube(const Vec3& at) {
  TriangleMesh mesh = testing::Cube(1);
  for (Vec3& p : mesh.positions) p = at + 0.5 * (p + Vec3{1, 1, 1});
  return mesh;
}

// Vertices at equal positions become one, whatever that makes of the mesh.
TriangleMesh BlindlyWelded(TriangleMesh mesh) {
  for (Triangle& t : mesh.triangles) {
    for (VertexId& v : t) {
      for (uint32_t w = 0; w < v.index(); ++w) {
        if (mesh.positions[w] == mesh.PositionAt(v)) v = VertexId(w);
      }
    }
  }
  return mesh;
}

TEST(Repair, TwoCubesThatShareAnEdgeComeApartAsTwoCubes) {
  const RepairResult result = Repaired(BlindlyWelded(shapes::Joined(UnitCube({0, 0, 0}), UnitCube({1, 1, 0}))));
  EXPECT_EQ(CountOf(result, "split_non_manifold_edges"), 1u);
  EXPECT_EQ(CountOf(result, "dropped_non_manifold_faces"), 0u);
  EXPECT_THAT(result.mesh, IsClosedManifold());
  EXPECT_THAT(result.mesh, HasComponents(2));
}

TriangleMesh Moebius(int n) {
  TriangleMesh mesh;
  for (int i = 0; i < n; ++i) {
    const double a = 2 * std::numbers::pi * i / n;
    const Vec3 r{std::cos(a), std::sin(a), 0}, w = std::cos(a / 2) * r + std::sin(a / 2) * Vec3{0, 0, 1};
    mesh.positions.push_back(2 * r - 0.5 * w);
    mesh.positions.push_back(2 * r + 0.5 * w);
  }
  for (int i = 0; i < n; ++i) {
    const bool last = i + 1 == n;
    const VertexId a(2 * i), b(2 * i + 1), c(last ? 1 : 2 * i + 2), d(last ? 0 : 2 * i + 3);
    mesh.triangles.push_back({a, c, b});
    mesh.triangles.push_back({c, d, b});
  }
  return mesh;
}

TEST(Repair, CutsAMoebiusStripOpenOnce) {
  const RepairResult result = Repaired(Moebius(20));
  EXPECT_EQ(CountOf(result, "cut_non_orientable_edges"), 1u);
  EXPECT_EQ(result.mesh.triangles.size(), 40u);
  EXPECT_THAT(result.mesh, HasComponents(1));
  EXPECT_THAT(result.mesh, HasBoundaryLoops(1));
  EXPECT_THAT(result.mesh, HasGenus(0));
}

TEST(Repair, WeldsASoupBackIntoASphere) {
  const RepairResult result = Repaired(testing::Soup(testing::Icosphere(2)));
  EXPECT_THAT(result.mesh, IsClosedManifold());
  EXPECT_EQ(result.mesh.positions.size(), testing::Icosphere(2).positions.size());
  EXPECT_EQ(CountOf(result, "welded_vertices"), 3 * 320u - 162u);
}

TEST(Repair, WeldsASoupWhoseCornersAlmostMeet) {
  const RepairResult result = Repaired(testing::WithNoise(testing::Soup(testing::Icosphere(2)), 1e-5, 4));
  EXPECT_GT(CountOf(result, "snapped_vertices"), 700u);
  EXPECT_THAT(result.mesh, IsClosedManifold());
  EXPECT_EQ(result.mesh.positions.size(), testing::Icosphere(2).positions.size());
}

// Made in rows as programs do, each pole and the seam twice: at an angle of 2π the sine is not 0, but 2e-16. `gap`: beyond that.
TriangleMesh SphereWithASeam(int around, int rings, double gap) {
  TriangleMesh mesh;
  for (int j = 0; j <= rings; ++j) {
    for (int i = 0; i <= around; ++i) {
      const double u = (2 * std::numbers::pi - gap) * i / around, v = std::numbers::pi * j / rings;
      mesh.positions.push_back({std::sin(v) * std::cos(u), std::sin(v) * std::sin(u), std::cos(v)});
    }
  }
  const auto id = [&](int i, int j) { return VertexId(static_cast<uint32_t>(j * (around + 1) + i)); };
  for (int j = 0; j < rings; ++j) {
    for (int i = 0; i < around; ++i) {
      if (j > 0) mesh.triangles.push_back({id(i, j), id(i, j + 1), id(i + 1, j)});
      if (j + 1 < rings) mesh.triangles.push_back({id(i + 1, j), id(i, j + 1), id(i + 1, j + 1)});
    }
  }
  return mesh;
}

TEST(Repair, ClosesASeamThatIsOffByRounding) {
  const RepairResult result = Repaired(SphereWithASeam(24, 12, 0));
  EXPECT_THAT(result.mesh, IsClosedManifold());
  EXPECT_THAT(result.mesh, HasGenus(0));
  EXPECT_GT(CountOf(result, "snapped_vertices"), 20u);
  EXPECT_EQ(result.mesh.positions.size(), 24u * 11 + 2);
}

// The same of a mesh that has nothing else to repair.
TEST(Repair, ClosesTheSeamOfABandThatIsOffByRounding) {
  TriangleMesh band;
  const int around = 24;
  for (int i = 0; i <= around; ++i) {
    const double u = 2 * std::numbers::pi * i / around;
    for (const double z : {0.0, 0.3}) band.positions.push_back({std::cos(u), std::sin(u), z});
  }
  for (uint32_t i = 0; i < around; ++i) {
    const VertexId a(2 * i), b(2 * i + 1), c(2 * i + 2), d(2 * i + 3);
    band.triangles.push_back({a, c, b});
    band.triangles.push_back({b, c, d});
  }
  const RepairResult result = Repaired(band);
  EXPECT_THAT(result.mesh, HasBoundaryLoops(2));
  EXPECT_THAT(Told(result), ::testing::HasSubstr("snapped_vertices"));
}

TEST(Repair, LeavesASlitOpenThatIsNot) {
  const RepairResult result = Repaired(SphereWithASeam(24, 12, 1e-5));
  EXPECT_THAT(result.mesh, HasBoundaryLoops(1));
  EXPECT_LE(CountOf(result, "snapped_vertices"), 24u) << "those of the pole";
}

// Sides of 1e-8 of the diagonal are no rounding where they are what is there.
TEST(Repair, LeavesAFineOpenPartBesideACoarseOneAlone) {
  const TriangleMesh fine = testing::Scaled(testing::Hemisphere(2), 1e-7);
  const TriangleMesh mesh = testing::Joined(testing::Icosphere(2), testing::Moved(fine, {4, 0, 0}));
  EXPECT_EQ(Told(Repaired(mesh)), "");
}

TEST(Repair, LeavesAScatterOfTrianglesAlone) {
  TriangleMesh mesh;
  for (int i = 0; i < 40; ++i) {
    mesh = shapes::Joined(mesh, shapes::MeshOf({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}),
                          {1.5 * (i % 7), 1.5 * (i / 7), 0});
  }
  EXPECT_EQ(Told(Repaired(mesh)), "");
}

TEST(Repair, CutsAKleinBottleWhereItsFileIsInconsistent) {
  // A grid of 12 × 10 quads, consistent but for the seam where it closes with one direction reversed: no face needs to
  // be reversed.
  TriangleMesh mesh = shapes::Torus(12, 10);
  const auto id = [&](int i, int j) { return VertexId(i == 12 ? (10 - j % 10) % 10 : i * 10 + j % 10); };
  mesh.triangles.clear();
  for (int i = 0; i < 12; ++i) {
    for (int j = 0; j < 10; ++j) {
      mesh.triangles.push_back({id(i, j), id(i + 1, j), id(i + 1, j + 1)});
      mesh.triangles.push_back({id(i, j), id(i + 1, j + 1), id(i, j + 1)});
    }
  }
  const RepairResult result = Repaired(mesh);
  EXPECT_EQ(CountOf(result, "cut_non_orientable_edges"), 10u);
  EXPECT_EQ(CountOf(result, "reversed_faces"), 0u);
  EXPECT_EQ(result.mesh.triangles.size(), 240u);
}

TEST(Repair, DoesNotWeldSheetsThatTouchInVerticesOnly) {
  // Two squares, corner to corner.
  const TriangleMesh mesh = shapes::Joined(shapes::Grid(1), shapes::Grid(1), {1, 1, 0});
  EXPECT_EQ(Told(Repaired(mesh)), "");
}

TEST(Repair, DoesNotJoinAnOpenSheetToItsBack) {
  // A card with a front and a back at the same positions: joined along the rim it would enclose nothing.
  const TriangleMesh mesh = shapes::Joined(shapes::Grid(2), testing::Reversed(shapes::Grid(2)));
  const RepairResult result = Repaired(mesh);
  EXPECT_EQ(Told(result), "");
  EXPECT_THAT(result.mesh, HasComponents(2));
}

TEST(Repair, DropsSplintersLaidOnEdges) {
  TriangleMesh mesh = testing::Icosphere(1);
  const size_t faces = mesh.triangles.size();
  for (size_t f = 0; f < 40; f += 4) {
    const VertexId a = mesh.triangles[f][0], b = mesh.triangles[f][1], middle(mesh.positions.size());
    mesh.positions.push_back(0.5 * (mesh.PositionAt(a) + mesh.PositionAt(b)));
    mesh.triangles.push_back({a, b, middle});
  }
  const RepairResult result = Repaired(mesh);
  EXPECT_EQ(CountOf(result, "dropped_degenerate_faces"), 10u);
  EXPECT_EQ(result.mesh.triangles.size(), faces);
  EXPECT_THAT(result.mesh, IsClosedManifold());
}

TEST(Repair, TurnsACapInsideAClosedMesh) {
  // A tetrahedron with a vertex 4 in the middle of edge 0-1 that only one of the two faces there knows: the other is
  // closed by a cap.
  const TriangleMesh mesh = shapes::MeshOf({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0.5, 0, 0}},
                                           {{0, 2, 1}, {0, 4, 3}, {4, 1, 3}, {0, 1, 4}, {1, 2, 3}, {2, 0, 3}});
  ASSERT_THAT(mesh, IsClosedManifold());
  EXPECT_THAT(RequireManifold(mesh), StatusIs(absl::StatusCode::kFailedPrecondition, "has no area"));
  const RepairResult result = Repaired(mesh);
  EXPECT_EQ(CountOf(result, "flipped_degenerate_faces"), 1u);
  EXPECT_EQ(result.mesh.triangles.size(), 6u);
  EXPECT_THAT(result.mesh, IsClosedManifold());
}

TEST(Repair, TurnsAStackOfCapsFromTheOutside) {
  // Three vertices in the middle of edge 0-1, closed by three caps of which only one touches a face with area.
  const TriangleMesh mesh = shapes::MeshOf(
      {{0, 0, 0}, {4, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}},
      {{0, 4, 3}, {4, 5, 3}, {5, 6, 3}, {6, 1, 3}, {0, 5, 4}, {0, 6, 5}, {0, 1, 6}, {0, 2, 1}, {1, 2, 3}, {2, 0, 3}});
  ASSERT_THAT(mesh, IsClosedManifold());
  const RepairResult result = Repaired(mesh);
  EXPECT_EQ(CountOf(result, "flipped_degenerate_faces"), 3u);
  EXPECT_THAT(result.mesh, IsClosedManifold());
}

TEST(Repair, ClosesTheMeshWhereANeedleWas) {
  // An edge of a sphere is opened and two needles put in: two vertices at (almost) the same point.
  for (const double apart : {0.0, 1e-16}) {
    TriangleMesh mesh = testing::Icosphere(1);
    // Vertex 0 becomes two: the faces of its fan from one neighbour to another go to the copy.
    const VertexId copy(mesh.positions.size());
    mesh.positions.push_back(mesh.positions[0] + Vec3{0, apart, 0});
    std::vector<size_t> fan;
    for (size_t f = 0; f < mesh.triangles.size(); ++f) {
      for (const VertexId v : mesh.triangles[f]) {
        if (v == VertexId(0)) fan.push_back(f);
      }
    }
    // Order the fan: each face's last corner is the next one's first.
    const auto corner = [&](size_t f, int k) {
      const Triangle& t = mesh.triangles[f];
      const int at = t[0] == VertexId(0) ? 0 : t[1] == VertexId(0) ? 1 : 2;
      return t[(at + k) % 3];
    };
    for (size_t i = 1; i < fan.size(); ++i) {
      for (size_t k = i; k < fan.size(); ++k) {
        if (corner(fan[k], 1) == corner(fan[i - 1], 2)) std::swap(fan[i], fan[k]);
      }
    }
    const VertexId first = corner(fan[0], 1), last = corner(fan[1], 2);
    for (const size_t f : {fan[0], fan[1]}) {
      for (VertexId& v : mesh.triangles[f]) {
        if (v == VertexId(0)) v = copy;
      }
    }
    mesh.triangles.push_back({VertexId(0), copy, last});
    mesh.triangles.push_back({copy, VertexId(0), first});
    if (!MeasureTopology(mesh).oriented) {
      shapes::Reverse(mesh.triangles[mesh.triangles.size() - 1]);
      shapes::Reverse(mesh.triangles[mesh.triangles.size() - 2]);
    }
    ASSERT_THAT(mesh, IsClosedManifold());
    const RepairResult result = Repaired(mesh);
    EXPECT_EQ(CountOf(result, "dropped_degenerate_faces"), 2u);
    EXPECT_EQ(CountOf(result, "welded_vertices"), 1u);
    EXPECT_THAT(result.mesh, IsClosedManifold());
  }
}

TEST(Repair, MovesASpikeBackToItsNeighboursAndLeavesStretchedShapesAlone) {
  TriangleMesh mesh = testing::Icosphere(3);
  mesh.positions[17] = {1e12, 0, 0};
  const RepairResult result = Repaired(mesh);
  EXPECT_EQ(CountOf(result, "moved_spike_vertices"), 1u);
  EXPECT_LT(BoundingBox(result.mesh).Diagonal(), 4);
  EXPECT_EQ(Told(Repaired(testing::Ellipsoid(3, {1e8, 1, 1}))), "");
  EXPECT_EQ(Told(Repaired(testing::UvSphere(24, 12, 1e-30))), "");
  EXPECT_EQ(Told(Repaired(testing::Scaled(testing::Icosphere(2), 1e100))), "");
}

TEST(Repair, KeepsANeedleThatIsAllThereIs) {
  const TriangleMesh mesh = shapes::MeshOf({{0, 0, 0}, {1, 0, 0}, {0.5, 1e-12, 0}}, {{0, 1, 2}});
  EXPECT_EQ(Told(Repaired(mesh)), "");
}

TEST(Repair, RefusesWhatHasNoSurfaceAndSaysWhy) {
  const auto error = [](const TriangleMesh& mesh) { return RepairMesh(mesh, Context{}).status(); };
  EXPECT_THAT(error({}), StatusIs(absl::StatusCode::kInvalidArgument, "has no triangles"));
  EXPECT_THAT(error(shapes::MeshOf({{0, 0, 0}, {1, 1, 1}, {2, 2, 2}}, {{0, 1, 2}})),
              StatusIs(absl::StatusCode::kInvalidArgument, "1 have no area"));
  EXPECT_THAT(error(testing::Scaled(testing::Icosphere(1), 1e300)),
              StatusIs(absl::StatusCode::kInvalidArgument, "beyond ±1e+150"));
  EXPECT_THAT(error(testing::Scaled(testing::Icosphere(1), 1e-300)),
              StatusIs(absl::StatusCode::kInvalidArgument, "at least 1e-150"));
  EXPECT_THAT(error(shapes::MeshOf({{0, 0, 0}, {1, 0, 0}}, {{0, 1, 2}})),
              StatusIs(absl::StatusCode::kInvalidArgument, "triangle 0 names vertex 2; the mesh has 2 vertices"));
}

TEST(Repair, StopsWhenTold) {
  std::atomic<bool> stop{true};
  Context context;
  context.stop = &stop;
  EXPECT_EQ(RepairMesh(shapes::Tetrahedron(), context).status().code(), absl::StatusCode::kCancelled);
}

TEST(Repair, MakesAManifoldOfRandomSoups) {
  int meshable = 0;
  for (uint32_t seed = 0; seed < 4000; ++seed) {
    const TriangleMesh mesh = shapes::RandomSoup(4 + seed % 20, 3 + seed % 41, seed);
    SCOPED_TRACE(seed);
    if (RepairMesh(mesh, Context{}).ok()) Repaired(mesh), ++meshable;
    if (HasFailure()) return;
  }
  EXPECT_GT(meshable, 3900);
}

TEST(Repair, MakesAManifoldOfBrokenShapes) {
  for (uint32_t seed = 0; seed < 300; ++seed) {
    std::mt19937 random(seed);
    TriangleMesh mesh = seed % 3 == 0 ? testing::Icosphere(2) : seed % 3 == 1 ? shapes::Torus(10, 8) : shapes::Grid(8);
    if (seed % 2 == 0) mesh = testing::Soup(mesh);
    for (int i = 0; i < 12; ++i) {
      Triangle& t = mesh.triangles[random() % mesh.triangles.size()];
      switch (random() % 5) {
        case 0:
          shapes::Reverse(t);
          break;
        case 1:
          t[random() % 3] = VertexId(random() % mesh.positions.size());
          break;
        case 2:
          mesh.positions[random() % mesh.positions.size()] = mesh.positions[random() % mesh.positions.size()];
          break;
        case 3:
          mesh.triangles.push_back(mesh.triangles[random() % mesh.triangles.size()]);
          break;
        case 4:
          mesh.positions[t[0].index()] = 0.5 * (mesh.PositionAt(t[1]) + mesh.PositionAt(t[2]));
          break;
      }
    }
    SCOPED_TRACE(seed);
    Repaired(mesh);
    if (HasFailure()) return;
  }
}

TEST(Defects, CountsAllAndListsSome) {
  TriangleMesh mesh = shapes::Grid(4);
  for (int i = 0; i < 5; ++i) mesh.triangles.push_back({VertexId(1), VertexId(1), VertexId(2)});
  const DefectList list = FindDefects(mesh, 2);
  EXPECT_EQ(list.total, 5u);
  ASSERT_EQ(list.defects.size(), 2u);
  EXPECT_EQ(list.defects[0].what, "degenerate_face");
  EXPECT_EQ(list.defects[0].faces[0], FaceId(32));
  EXPECT_EQ(FindDefects(shapes::Torus(5, 5)).total, 0u);
}

TEST(Defects, NamesEdgesAndVerticesWithTheirPlaces) {
  TriangleMesh mesh =
      shapes::MeshOf({{0, 0, 0}, {2, 0, 0}, {1, 1, 0}, {1, -1, 0}, {1, 0, 1}}, {{0, 1, 2}, {1, 0, 3}, {0, 1, 4}});
  const DefectList list = FindDefects(mesh);
  ASSERT_EQ(list.total, 1u);
  EXPECT_EQ(list.defects[0].what, "non_manifold_edge");
  EXPECT_EQ(list.defects[0].position, (Vec3{1, 0, 0}));
  EXPECT_THAT(list.defects[0].faces, ::testing::ElementsAre(FaceId(0), FaceId(1), FaceId(2)));
}

TEST(Defects, HaveNoPlaceWhereItIsNotFiniteButNameTheVertexAndTheFace) {
  TriangleMesh mesh = shapes::MeshOf({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}});
  mesh.positions[1].y = std::numeric_limits<double>::quiet_NaN();
  const DefectList list = FindDefects(mesh);
  ASSERT_EQ(list.total, 1u);
  EXPECT_EQ(list.defects[0].what, "non_finite_vertex");
  EXPECT_FALSE(list.defects[0].position);
  EXPECT_THAT(list.defects[0].vertices, ::testing::ElementsAre(VertexId(1)));
  EXPECT_THAT(list.defects[0].message, ::testing::HasSubstr("vertex 1 of triangle 0"));
  EXPECT_THAT(list.defects[0].message, ::testing::Not(::testing::HasSubstr("nan")));
}

TEST(Repair, OfAMeshWithNothingToMeshNamesTheFirstDefectAndItsPlace) {
  const TriangleMesh line = shapes::MeshOf({{1, 2, 3}, {2, 2, 3}, {3, 2, 3}}, {{0, 1, 2}});
  EXPECT_THAT(RepairMesh(line, {}), StatusIs(absl::StatusCode::kInvalidArgument, "triangle 0 at (1, 2, 3)"));
  TriangleMesh broken = line;
  for (Vec3& p : broken.positions) p.x = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(RepairMesh(broken, {}), StatusIs(absl::StatusCode::kInvalidArgument, "vertex 0 of triangle 0"));
}

// Each corner three times, and two faces that go: one without area in front, and a double at the end.
TEST(RepairMesh, TakesTheOriginsOfFacesAlong) {
  TriangleMesh mesh = testing::Soup(testing::Cube(2));
  mesh.triangles.insert(mesh.triangles.begin(), {VertexId(0), VertexId(0), VertexId(1)});
  mesh.triangles.push_back(mesh.triangles[5]);
  for (uint32_t f = 0; f < mesh.triangles.size(); ++f) mesh.face_origins.push_back(f);
  const TriangleMesh before = mesh;
  const auto repaired = RepairMesh(std::move(mesh), {});
  ASSERT_THAT(repaired, testing::IsOk());
  const TriangleMesh& after = repaired->mesh;
  ASSERT_EQ(after.face_origins.size(), after.triangles.size());
  EXPECT_EQ(after.triangles.size(), before.triangles.size() - 2);
  for (size_t f = 0; f < after.triangles.size(); ++f) {
    for (int i = 0; i < 3; ++i) {
      EXPECT_EQ(after.PositionAt(after.triangles[f][i]), before.PositionAt(before.triangles[after.face_origins[f]][i]));
    }
  }
}

TEST(RepairMesh, LeavesComponentsThatFaceInwardsWhereThatIsAskedFor) {
  const TriangleMesh mesh = testing::Reversed(testing::Icosphere(1));
  const auto repaired = RepairMeshAsOriented(mesh, {});
  ASSERT_THAT(repaired, testing::IsOk());
  EXPECT_EQ(repaired->mesh.triangles, mesh.triangles);
  EXPECT_TRUE(repaired->actions.empty());
}

}  // namespace
}  // namespace meshfront
