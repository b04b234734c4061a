#include "core/surface/crease_cut.h"

#include <atomic>
#include <cmath>
#include <map>
#include <memory>
#include <numbers>
#include <set>
#include <utility>
#include <vector>

#include "core/surface/mesh_surface.h"
#include "tests/support/matchers.h"
#include "tests/support/shapes.h"
#include "tests/support/sharp_edges.h"

namespace meshfront {
namespace {

using ::testing::Each;
using testing::IsOk;
using ::testing::SizeIs;

constexpr double kDegree = std::numbers::pi / 180;

CreaseCut CutAtSharpEdges(const TriangleMesh& mesh) {
  const FaceAdjacency adjacency = CreateAdjacency(mesh);
  return CutAlongCreases(mesh, adjacency, testing::SharpEdges(mesh, adjacency));
}

// The half-edges between these places, both ways.
std::vector<bool> FlagsBetween(const TriangleMesh& mesh, const std::vector<std::pair<Vec3, Vec3>>& edges) {
  std::vector<bool> flags(3 * mesh.triangles.size(), false);
  for (uint32_t h = 0; h < flags.size(); ++h) {
    const Vec3 from = mesh.PositionAt(OriginOf(mesh, h)), to = mesh.PositionAt(TargetOf(mesh, h));
    for (const auto& [a, b] : edges) flags[h] = flags[h] || (from == a && to == b) || (from == b && to == a);
  }
  return flags;
}

// What a cut mesh must be: faces and places as before, a fan of faces at each vertex that begins at its outgoing half-edge, and sides
// that fit each other.
void ExpectSound(const CreaseCut& cut, const TriangleMesh& before) {
  ASSERT_EQ(cut.mesh.triangles.size(), before.triangles.size());
  ASSERT_EQ(cut.original.size(), cut.mesh.positions.size());
  ASSERT_EQ(cut.adjacency.outgoing.size(), cut.mesh.positions.size());
  for (uint32_t h = 0; h < 3 * before.triangles.size(); ++h) {
    const VertexId v = OriginOf(cut.mesh, h);
    EXPECT_EQ(VertexId(cut.original[v.index()]), OriginOf(before, h));
    EXPECT_EQ(cut.mesh.PositionAt(v), before.PositionAt(OriginOf(before, h)));
    const uint32_t across = cut.adjacency.OppositeOf(h);
    if (across == kNoHalfEdge) continue;
    EXPECT_EQ(OriginOf(cut.mesh, across), TargetOf(cut.mesh, h));
    EXPECT_EQ(TargetOf(cut.mesh, across), OriginOf(cut.mesh, h));
  }
  size_t corners = 0;
  for (uint32_t v = 0; v < cut.mesh.positions.size(); ++v) {
    const uint32_t first = cut.adjacency.outgoing[v];
    uint32_t h = first;
    do {
      EXPECT_EQ(OriginOf(cut.mesh, h), VertexId(v));
      ++corners;
      h = cut.adjacency.NextAroundOrigin(h);
    } while (h != kNoHalfEdge && h != first);
  }
  EXPECT_EQ(corners, 3 * before.triangles.size()) << "each corner of a face is reached from its vertex, once";
  EXPECT_TRUE(HasSingleFans(cut.mesh, cut.adjacency));
}

TEST(CreaseCut, TakesACubeApart) {
  for (const int n : {1, 4}) {
    const TriangleMesh cube = testing::Cube(n);
    const CreaseCut cut = CutAtSharpEdges(cube);
    ExpectSound(cut, cube);
    EXPECT_THAT(cut.mesh.positions, SizeIs(6 * (n + 1) * (n + 1)));
    EXPECT_EQ(LabelComponents(cut.adjacency).count, 6u);
    EXPECT_EQ(cut.opposite, CreateAdjacency(cube).opposite) << "as it was";
    for (uint32_t v = 0; v < cube.positions.size(); ++v) EXPECT_EQ(cut.original[v], v) << "copies come behind";
  }
}

TEST(CreaseCut, BeginsEachFanAtItsRim) {
  const CreaseCut cut = CutAtSharpEdges(testing::Cube(3));
  for (uint32_t v = 0; v < cut.mesh.positions.size(); ++v) {
    const Vec3& p = cut.mesh.positions[v];
    const bool on_edge = (std::abs(p.x) == 1) + (std::abs(p.y) == 1) + (std::abs(p.z) == 1) >= 2;
    EXPECT_EQ(cut.adjacency.IsRimVertex(v), on_edge);
  }
}

TEST(CreaseCut, DoublesOnlyTheInnerVerticesOfALineThatEndsInside) {
  const TriangleMesh sheet = testing::Sheet(8);
  const FaceAdjacency adjacency = CreateAdjacency(sheet);
  const auto line = [](int edges) {
    std::vector<std::pair<Vec3, Vec3>> all;
    for (int i = 0; i < edges; ++i) all.push_back({{0.25 * i - 0.5, 0, 0}, {0.25 * i - 0.25, 0, 0}});
    return all;
  };
  for (const int edges : {1, 3}) {
    const CreaseCut cut = CutAlongCreases(sheet, adjacency, FlagsBetween(sheet, line(edges)));
    ExpectSound(cut, sheet);
    EXPECT_THAT(cut.mesh.positions, SizeIs(81 + edges - 1));
    EXPECT_EQ(LabelComponents(cut.adjacency).count, 1u);
    EXPECT_THAT(FindBoundaryLoops(cut.adjacency), SizeIs(2)) << "the slit is a rim";
  }
}

TEST(CreaseCut, CutsASheetFromRimToRim) {
  const TriangleMesh roof = testing::HeightField(8, [](double, double y) { return -std::abs(y); });
  const CreaseCut cut = CutAtSharpEdges(roof);
  ExpectSound(cut, roof);
  EXPECT_THAT(cut.mesh.positions, SizeIs(81 + 9));
  EXPECT_EQ(LabelComponents(cut.adjacency).count, 2u);
  EXPECT_THAT(FindBoundaryLoops(cut.adjacency), SizeIs(2));
}

TEST(CreaseCut, GivesAVertexOnePlaceForEachPatchAroundIt) {
  // An L of three boxes: only at the two squares' corners inside its long walls do no more than two patches meet.
  const TriangleMesh block = testing::Blocks({2, 2, 1}, [](int x, int y, int) { return x + y < 2; });
  const CreaseCut cut = CutAtSharpEdges(block);
  ExpectSound(cut, block);
  std::map<uint32_t, int> copies;
  for (const uint32_t v : cut.original) ++copies[v];
  for (uint32_t v = 0; v < block.positions.size(); ++v) {
    const Vec3& p = block.positions[v];
    const bool inside_a_wall = (p.x == 1 && p.y == 0) || (p.x == 0 && p.y == 1);
    EXPECT_EQ(copies[v], inside_a_wall ? 2 : 3) << p.x << " " << p.y << " " << p.z;
  }
}

// --- As a surface ----------------------------------------------------------------------------------------------------------

std::unique_ptr<MeshSurface> CreasedSurfaceOf(const TriangleMesh& mesh) {
  FaceAdjacency adjacency = CreateAdjacency(mesh);
  const std::vector<bool> creases = testing::SharpEdges(mesh, adjacency);
  auto surface = MeshSurface::Create(mesh, std::move(adjacency), creases, Context{});
  EXPECT_THAT(surface, IsOk());
  EXPECT_THAT((*surface)->ComputeCurvature(Context{}), IsOk());
  return *std::move(surface);
}

TEST(CreasedSurface, IsUncutWithoutCreases) {
  const auto surface = CreasedSurfaceOf(testing::Icosphere(3));
  EXPECT_FALSE(surface->is_cut());
  EXPECT_EQ(surface->component_count(), 1u);
  EXPECT_EQ(surface->OriginalOf(VertexId(7)), 7u);
  EXPECT_EQ(surface->AcrossCrease(7), kNoHalfEdge);
}

TEST(CreasedSurface, HasOneSidedNormalsAndNoCurvatureOnACubesFaces) {
  const auto surface = CreasedSurfaceOf(testing::Cube(6));
  EXPECT_EQ(surface->component_count(), 6u);
  for (uint32_t f = 0; f < surface->mesh().triangles.size(); ++f) {
    const Vec3 normal = testing::FaceNormal(surface->mesh(), f);
    for (const VertexId v : surface->mesh().triangles[f]) {
      EXPECT_LT(Distance(surface->vertex_normals()[v.index()], normal), 1e-15);
      EXPECT_LT(surface->vertex_curvatures()[v.index()], 1e-9);
    }
  }
}

TEST(CreasedSurface, KnowsWhatLiesAcrossItsCreases) {
  // A box without its lid: four creases around the floor, four up the walls, and a rim.
  TriangleMesh box = testing::Cube(3);
  std::erase_if(box.triangles, [&](const Triangle& t) {
    return std::min({box.PositionAt(t[0]).z, box.PositionAt(t[1]).z, box.PositionAt(t[2]).z}) == 1;
  });
  box = testing::WithoutUnreferenced(box);
  const auto surface = CreasedSurfaceOf(box);
  int creases = 0, rims = 0;
  for (uint32_t h = 0; h < 3 * box.triangles.size(); ++h) {
    const uint32_t across = surface->AcrossCrease(h);
    rims += surface->adjacency().OppositeOf(h) == kNoHalfEdge && across == kNoHalfEdge;
    if (across == kNoHalfEdge) continue;
    ++creases;
    EXPECT_EQ(surface->AcrossCrease(across), h);
    EXPECT_NE(surface->ComponentOf(FaceId(h / 3)), surface->ComponentOf(FaceId(across / 3)));
    const VertexId from = OriginOf(surface->mesh(), h), to = TargetOf(surface->mesh(), across);
    EXPECT_NE(from, to);
    EXPECT_EQ(surface->OriginalOf(from), surface->OriginalOf(to));
  }
  EXPECT_EQ(creases, 2 * 8 * 3);
  EXPECT_EQ(rims, 4 * 3);
}

TEST(CreasedSurface, TellsItsSheetsApart) {
  const auto surface = CreasedSurfaceOf(testing::Cube(3));
  std::map<uint32_t, std::set<uint32_t>> sheets_at;
  for (uint32_t v = 0; v < surface->mesh().positions.size(); ++v) {
    const SourcePoint p = surface->AtVertex(VertexId(v));
    EXPECT_TRUE(sheets_at[surface->OriginalOf(VertexId(v))].insert(surface->SheetOf(p)).second);
    const SourcePoint inner = surface->Snap(p, 0.5 * p.position + 0.5 * p.normal);
    EXPECT_EQ(surface->SheetOf(inner), surface->SheetOf(p));
  }
}

TEST(CreasedSurface, DoesNotWalkAcrossACrease) {
  const auto surface = CreasedSurfaceOf(testing::Cube(4));
  for (uint32_t f = 0; f < surface->mesh().triangles.size(); ++f) {
    const SourcePoint start = surface->AtFace(FaceId(f), 0.3, 0.3);
    const SourcePoint behind = surface->Snap(start, -2 * start.position);
    EXPECT_NEAR(Dot(behind.position, start.normal), 1, 1e-12) << "stays on its side";
  }
}

TEST(CreasedSurface, MeasuresTheWholeThatAPatchIsAPartOf) {
  const auto surface = CreasedSurfaceOf(
      testing::Joined(testing::Cube(2), testing::Moved(testing::Scaled(testing::Cube(2), 0.5), {5, 0, 0})));
  ASSERT_EQ(surface->component_count(), 12u);
  for (uint32_t f = 0; f < surface->mesh().triangles.size(); ++f) {
    const double side = surface->AtFace(FaceId(f), 0.3, 0.3).position.x > 3 ? 1 : 2;
    const uint32_t patch = surface->ComponentOf(FaceId(f));
    EXPECT_NEAR(surface->component_diagonals()[patch], side * std::sqrt(2.0), 1e-12);
    EXPECT_NEAR(surface->whole_diagonals()[patch], side * std::sqrt(3.0), 1e-12);
  }
}

TEST(CreasedSurface, DoesNotMeetItselfAlongItsCreases) {
  const auto cube = CreasedSurfaceOf(testing::Cube(4));
  for (const Vec3& place : {Vec3{1, 1, 1}, {1, 1, 0}, {1, 0.25, -1}, {1, 0, 0}})
    EXPECT_FALSE(cube->MeetsItselfNear(place, 0.4, Context{}));
  const auto crossed =
      CreasedSurfaceOf(testing::Joined(testing::Cube(4), testing::Moved(testing::Cube(4), {0.6, 0.7, 0.8})));
  EXPECT_TRUE(crossed->MeetsItselfNear({1, -0.3, 0.4}, 0.4, Context{})) << "where another box passes through";
}

// Two large faces that cross: only near the stretch along which they do.
TEST(MeetsItselfNear, IsSaidOfTheStretchNotOfTheFaces) {
  TriangleMesh mesh;
  mesh.positions = {{-9, -9, 0}, {9, -9, 0}, {0, 9, 0}, {0, 0, -1}, {0, 1, 1}, {0, -1, 1}};
  mesh.triangles = {{VertexId(0), VertexId(1), VertexId(2)}, {VertexId(3), VertexId(4), VertexId(5)}};
  const auto surface = MeshSurface::Create(mesh, Context{});
  ASSERT_THAT(surface, IsOk());
  EXPECT_TRUE((*surface)->MeetsItselfNear({0.1, 0.2, 0}, 0.2, Context{}));
  EXPECT_TRUE((*surface)->MeetsItselfNear({0, 0, 0.9}, 0.95, Context{}));
  EXPECT_FALSE((*surface)->MeetsItselfNear({0.3, 0.2, 0}, 0.2, Context{}))
      << "in the box around both, beside the stretch";
  EXPECT_FALSE((*surface)->MeetsItselfNear({0, 0, 0.9}, 0.8, Context{}));
}

// Three sheets that shared an edge, which repair gave to each of them.
TEST(MeetsItselfNear, IsSaidOfASeam) {
  TriangleMesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0.5, 1, 0}, {1, 0, 0}, {0, 0, 0}, {0.5, -1, 1}};
  mesh.triangles = {{VertexId(0), VertexId(1), VertexId(2)}, {VertexId(3), VertexId(4), VertexId(5)}};
  const auto surface = MeshSurface::Create(mesh, Context{});
  ASSERT_THAT(surface, IsOk());
  EXPECT_TRUE((*surface)->MeetsItselfNear({0.5, 0.1, 0}, 0.11, Context{}));
  EXPECT_FALSE((*surface)->MeetsItselfNear({0.5, 0.5, 0}, 0.4, Context{}));
}

// The index is made at the first question; when the job is stopped the answer no longer matters, and must come at once.
TEST(MeetsItselfNear, IsSaidWhenTheJobIsStopped) {
  const auto surface = CreasedSurfaceOf(testing::Cube(4));
  const std::atomic<bool> stop = true;
  Context context;
  context.stop = &stop;
  EXPECT_TRUE(surface->MeetsItselfNear({1, 1, 1}, 0.4, context));
}

// Vertices at one place that are not joined: the fans touch there as they did before they were parted.
TEST(MeetsItselfNear, IsNotSaidOfFansThatWereParted) {
  TriangleMesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 0}, {-1, 0, 0.5}, {0, -1, 0.5}};
  mesh.triangles = {{VertexId(0), VertexId(1), VertexId(2)}, {VertexId(3), VertexId(4), VertexId(5)}};
  const auto surface = MeshSurface::Create(mesh, Context{});
  ASSERT_THAT(surface, IsOk());
  EXPECT_FALSE((*surface)->MeetsItselfNear({0, 0, 0}, 0.5, Context{}));
}

// The distances that the samples at the vertices carry, with the same ideal length everywhere.
std::vector<double> SheetDistances(const MeshSurface& surface, double length) {
  const double longest = kLongestSheetReachPerDiagonal * BoundingBox(surface.mesh()).Diagonal();
  const std::vector<double> limits(surface.mesh().positions.size(), std::min(kSheetReachPerLength * length, longest));
  auto distances = surface.SheetDistances(limits, Context{});
  EXPECT_THAT(distances, IsOk());
  return *std::move(distances);
}

TEST(CreasedSurface, IsThinWhereAPlateIs) {
  const auto plate = CreasedSurfaceOf(testing::Extruded(testing::Sheet(40), 0.05));
  const auto distances = SheetDistances(*plate, 0.2);
  int measured = 0;
  for (uint32_t v = 0; v < distances.size(); ++v) {
    const Vec3 p = plate->mesh().positions[v], n = plate->vertex_normals()[v];
    if (std::abs(n.z) < 0.5) {
      EXPECT_EQ(distances[v], INFINITY) << "a wall, whose other side is far";
    } else if (std::max(std::abs(p.x), std::abs(p.y)) < 0.89) {
      EXPECT_NEAR(distances[v], 0.05, 1e-12);
      ++measured;
    }
  }
  EXPECT_GT(measured, 2000);
}

// The distances measured on the side of a wedge that lies along x, between two distances from its tip, over the thickness there.
std::vector<double> SheetDistancesPerThickness(double degrees, int n, double from, double to) {
  const auto wedge = CreasedSurfaceOf(testing::Wedge(degrees * kDegree, n));
  const auto distances = SheetDistances(*wedge, 0.6);
  std::vector<double> measured;
  for (uint32_t v = 0; v < distances.size(); ++v) {
    const Vec3 p = wedge->mesh().positions[v];
    const bool on_side = wedge->vertex_normals()[v].y < -0.9 && p.x > from && p.x < to;
    if (on_side && p.z > 0.4 && p.z < 1.6) measured.push_back(distances[v] / (p.x * std::tan(degrees * kDegree)));
  }
  EXPECT_GE(measured.size(), 7u);
  return measured;
}

TEST(CreasedSurface, IsThinNearTheTipOfASharpWedge) {
  // The way around the tip of 15° is 7.6 times as long as the way through.
  for (const double share : SheetDistancesPerThickness(15, 40, 0.3, 0.9)) {
    EXPECT_LE(share, 1 + 1e-12);
    EXPECT_GE(share, 0.6) << "of a probe near by, where it is thinner";
  }
}

TEST(CreasedSurface, IsOneBentSheetNearTheTipOfABluntWedge) {
  // The way around the tip of 55°, over its crease, is only 1.9 times as long as the way through.
  for (const double share : SheetDistancesPerThickness(55, 12, 0.1, 0.2)) EXPECT_EQ(share, INFINITY);
}

}  // namespace
}  // namespace meshfront
