// A part cut out of a surface: what it keeps of the whole, and where its border is.
#include <cmath>
#include <functional>
#include <memory>
#include <set>
#include <utility>
#include <vector>

#include "core/surface/mesh_surface.h"
#include "gtest/gtest.h"
#include "tests/support/matchers.h"
#include "tests/support/shapes.h"

namespace meshfront {
namespace {

std::shared_ptr<const MeshSurface> SurfaceOf(TriangleMesh mesh) {
  auto surface = MeshSurface::Create(std::move(mesh), {});
  EXPECT_THAT(surface, testing::IsOk());
  EXPECT_THAT((*surface)->ComputeCurvature({}), testing::IsOk());
  return *std::move(surface);
}

std::vector<bool> FacesWhere(const TriangleMesh& mesh, const std::function<bool(const Vec3& middle)>& is_chosen) {
  std::vector<bool> chosen;
  for (const Triangle& t : mesh.triangles)
    chosen.push_back(is_chosen((mesh.PositionAt(t[0]) + mesh.PositionAt(t[1]) + mesh.PositionAt(t[2])) / 3.0));
  return chosen;
}

// A cap of a sphere: normals and curvature at its border are those of the sphere, not one-sided.
TEST(SurfacePart, KeepsNormalsCurvaturesAndSizesOfTheWhole) {
  const auto whole = SurfaceOf(testing::Icosphere(4));
  const auto part = MeshSurface::CreatePart(whole, FacesWhere(whole->mesh(), [](const Vec3& p) { return p.z > 0.5; }));
  for (uint32_t v = 0; v < part->mesh().positions.size(); ++v) {
    const uint32_t was = part->vertices_of_whole()[v];
    EXPECT_EQ(part->mesh().positions[v], whole->mesh().positions[was]);
    EXPECT_EQ(part->vertex_normals()[v], whole->vertex_normals()[was]);
    EXPECT_EQ(part->vertex_curvatures()[v], whole->vertex_curvatures()[was]);
  }
  EXPECT_EQ(part->whole_diagonals()[0], whole->whole_diagonals()[0]);
  EXPECT_TRUE(part->ComponentHasBoundary(0));
}

TEST(SurfacePart, HasABorderWhereTheWholeGoesOn) {
  const auto whole = SurfaceOf(testing::Sheet(8));
  const auto part = MeshSurface::CreatePart(whole, FacesWhere(whole->mesh(), [](const Vec3& p) { return p.x < 0; }));
  size_t border = 0, rim = 0;
  for (uint32_t h = 0; h < 3 * part->mesh().triangles.size(); ++h) {
    if (part->adjacency().OppositeOf(h) != kNoHalfEdge) continue;
    ++(part->IsBorder(h) ? border : rim);
  }
  EXPECT_EQ(border, 8u);
  EXPECT_EQ(rim, 16u);
  EXPECT_EQ(part->border_vertices().size(), 9u);
}

// Two squares of a sheet that touch in its middle: the vertex there is two in the part, and one original.
TEST(SurfacePart, PartsFansThatTouchInAVertex) {
  const auto whole = SurfaceOf(testing::Sheet(2));
  const auto part =
      MeshSurface::CreatePart(whole, FacesWhere(whole->mesh(), [](const Vec3& p) { return p.x * p.y > 0; }));
  EXPECT_EQ(part->component_count(), 2u);
  EXPECT_EQ(part->mesh().positions.size(), 8u);
  std::set<uint32_t> originals;
  for (uint32_t v = 0; v < 8; ++v) originals.insert(part->OriginalOf(VertexId(v)));
  EXPECT_EQ(originals.size(), 7u);
  EXPECT_EQ(part->border_vertices().size(), 5u);
}

// A square of two triangles in the middle of a sheet, without one of its neighbours' triangles: an edge of that joins two of its corners.
TEST(SurfacePart, KnowsTheEdgesThatTheRestHasBetweenVerticesOfTheBorder) {
  const auto whole = SurfaceOf(testing::Icosphere(0));
  std::vector<bool> chosen(20, true);
  chosen[0] = chosen[1] = false;
  ASSERT_NE(whole->adjacency().OppositeOf(0), kNoHalfEdge);
  const auto part = MeshSurface::CreatePart(whole, chosen);
  const bool are_neighbours = whole->adjacency().OppositeOf(0) / 3 == 1 || whole->adjacency().OppositeOf(1) / 3 == 1 ||
                              whole->adjacency().OppositeOf(2) / 3 == 1;
  EXPECT_EQ(part->taken().size(), are_neighbours ? 1u : 0u);
  EXPECT_TRUE(are_neighbours) << "else this says nothing";
}

// The other side of a plate lies outside of the part: distances are measured to it.
TEST(SurfacePart, MeasuresTheDistanceToSheetsOfTheRest) {
  const auto whole = SurfaceOf(testing::ThinSlab(20));
  const auto part = MeshSurface::CreatePart(whole, FacesWhere(whole->mesh(), [](const Vec3& p) {
                                              return p.z > 0.015 && std::abs(p.x) < 0.5 && std::abs(p.y) < 0.5;
                                            }));
  const std::vector<double> limits(part->mesh().positions.size(), 0.2);
  const auto distances = part->SheetDistances(limits, {});
  ASSERT_THAT(distances, testing::IsOk());
  for (const double d : *distances) EXPECT_NEAR(d, 0.04, 1e-6);
}

}  // namespace
}  // namespace meshfront
