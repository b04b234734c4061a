// What must hold for shapes with sharp edges, at every rho and eta: creases stay where they are, what lies between them stays flat.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <tuple>
#include <vector>

#include "core/geometry/bvh.h"
#include "core/geometry/triangle.h"
#include "core/remesh.h"
#include "tests/core/facade/grid_names.h"
#include "tests/core/facade/zoo.h"
#include "tests/support/checking_sink.h"
#include "tests/support/matchers.h"
#include "tests/support/shapes.h"
#include "tests/support/sharp_edges.h"

namespace meshfront::testing {
namespace {

using ::testing::AllOf;
using ::testing::Combine;
using ::testing::IsEmpty;
using ::testing::ValuesIn;

struct SharpShape {
  std::string name;
  TriangleMesh (*make)();
  bool has_flat_faces_only = true;
};
void PrintTo(const SharpShape& shape, std::ostream* out) { *out << shape.name; }

TriangleMesh Box(int n) {
  return Mapped(Cube(n), [](const Vec3& p) { return Vec3{p.x, 1.5 * p.y, 0.7 * p.z}; });
}

TriangleMesh OpenBox() {
  TriangleMesh box = Box(6);
  std::erase_if(box.triangles, [&](const Triangle& t) {
    return std::all_of(t.begin(), t.end(), [&](VertexId v) { return box.PositionAt(v).z > 0.69; });
  });
  return WithoutUnreferenced(box);
}

std::vector<SharpShape> SharpShapes() {
  return {
      {"BoxOfTwelveTriangles", [] { return Box(1); }},
      {"Box", [] { return Box(8); }},
      {"LBlock",
       [] {
         return Blocks(
             {3, 3, 2}, [](int x, int y, int) { return x == 0 || y == 0; }, 2);
       }},
      {"PlateWithRoundHole", [] { return PlateWithRoundHole(); }, false},
      {"CappedCylinder", [] { return CappedCylinder(1, 2, 48, 8); }, false},
      {"Prism", [] { return CappedCylinder(1, 2, 6, 1); }},
      {"Wedge", [] { return Wedge(std::numbers::pi / 12); }},
      {"TwoBoxes",
       [] {
         return Joined(Box(3), Moved(Box(2), {2.5, 0, 0}));
       }},
      {"OpenBox", OpenBox},
      {"BoxWithBoss",
       [] {
         return Blocks({5, 5, 2}, [](int x, int y, int z) { return z == 0 || (x / 2 == 1 && y / 2 == 1); });
       }},
      {"ThinPlate", [] { return Extruded(Sheet(4), 0.01); }},
      {"NarrowWedge", [] { return Wedge(std::numbers::pi / 36, 4); }},
      {"Pillow", Pillow, false},
      {"Lens", [] { return Lens(0.5); }, false},
      {"HalfDiskPrism", HalfDiskPrism, false},
      {"DropPrism", DropPrism, false},
      {"Pyramid", [] { return Pyramid(1); }},
      {"Needle", [] { return Pyramid(12); }},
      {"Star", [] { return StarPrism(5, 0.4, 0.6); }},
      {"SharpStar", [] { return StarPrism(7, 0.2, 0.1); }},
      {"Stairs",
       [] {
         return Blocks({4, 2, 4}, [](int x, int, int z) { return z <= x; });
       }},
      {"Frame",
       [] {
         return Blocks({3, 3, 3}, [](int x, int y, int z) { return (x == 1) + (y == 1) + (z == 1) < 2; });
       }},
      {"Cavity",
       [] {
         return Blocks({3, 3, 3}, [](int x, int y, int z) { return !(x == 1 && y == 1 && z == 1); });
       }},
      {"Roof", [] { return HeightField(10, [](double, double y) { return -std::abs(y); }); }},
      {"Cross", [] { return HeightField(10, [](double x, double y) { return -std::abs(y) - std::abs(x); }); }},
  };
}

std::vector<SharpShape> FlatShapes() {
  std::vector<SharpShape> flat = SharpShapes();
  std::erase_if(flat, [](const SharpShape& shape) { return !shape.has_flat_faces_only; });
  return flat;
}

struct Outcome {
  TriangleMesh mesh;
  Report report;
};

Outcome RemeshOrFail(const TriangleMesh& input, const RemeshOptions& options, int threads = 1) {
  CheckingSink sink;
  Context context;
  context.threads = threads;
  absl::StatusOr<Report> report = Remesh({input, options}, sink, context);
  EXPECT_THAT(report, IsOk());
  if (!report.ok()) return {};
  sink.CheckEnd();
  EXPECT_THAT(sink.complaints(), IsEmpty());
  return {sink.mesh(), *std::move(report)};
}

double SizeOf(const TriangleMesh& mesh) { return BoundingBox(mesh).Diagonal(); }

double VolumeOf(const TriangleMesh& mesh) {
  double six = 0;
  for (const Triangle& t : mesh.triangles)
    six += Dot(mesh.PositionAt(t[0]), Cross(mesh.PositionAt(t[1]), mesh.PositionAt(t[2])));
  return six / 6;
}

double AreaOf(const TriangleMesh& mesh) {
  double area = 0;
  for (const Triangle& t : mesh.triangles)
    area += TriangleArea(mesh.PositionAt(t[0]), mesh.PositionAt(t[1]), mesh.PositionAt(t[2]));
  return area;
}

std::vector<Segment> CreasesOf(const TriangleMesh& mesh) {
  const FaceAdjacency adjacency = CreateAdjacency(mesh);
  return SegmentsOf(mesh, adjacency, SharpEdges(mesh, adjacency));
}

double LengthOf(const std::vector<Segment>& segments) {
  double length = 0;
  for (const Segment& s : segments) length += Distance(s.from, s.to);
  return length;
}

class EverySharpShape : public ::testing::TestWithParam<std::tuple<SharpShape, double, double>> {
 protected:
  void SetUp() override {
    RemeshOptions options;
    options.rho = std::get<1>(GetParam());
    options.eta = std::get<2>(GetParam());
    out = RemeshOrFail(input, options);
  }
  const SharpShape& shape() const { return std::get<0>(GetParam()); }

  TriangleMesh input = shape().make();
  Outcome out;
};

TEST_P(EverySharpShape, KeepsItsTopologyAndDoesNotIntersectItself) {
  const TopologyReport before = MeasureTopology(input), after = MeasureTopology(out.mesh);
  EXPECT_TRUE(out.report.complete);
  EXPECT_THAT(out.mesh, AllOf(IsManifold(), HasComponents(before.components), HasGenus(*before.genus),
                              HasBoundaryLoops(before.boundary_loops)));
  EXPECT_EQ(after.closed, before.closed);
  EXPECT_THAT(out.mesh, HasNoSelfIntersection());
  EXPECT_EQ(out.report.output.triangles, after.triangles);
  EXPECT_EQ(out.report.output.vertices, after.vertices);
  EXPECT_EQ(out.report.output.components, after.components);
  EXPECT_EQ(out.report.output.boundary_edges, after.boundary_edges);
  EXPECT_EQ(out.report.output.boundary_loops, after.boundary_loops);
  EXPECT_EQ(out.report.output.genus, after.genus);
}

// Every sharp edge of the output runs from one place on a crease of the input to another, and nothing of them is lost:
// straight ones are as long as before, round ones lose what chords do.
TEST_P(EverySharpShape, HasItsCreasesWhereTheyWere) {
  const std::vector<Segment> before = CreasesOf(input), after = CreasesOf(out.mesh);
  for (const Segment& s : after) {
    for (const Vec3& p : {s.from, s.to}) {
      double nearest = INFINITY;
      for (const Segment& crease : before) nearest = std::min(nearest, DistanceTo(crease, p));
      EXPECT_LT(nearest, 1e-12 * SizeOf(input));
    }
  }
  if (shape().has_flat_faces_only)
    EXPECT_NEAR(LengthOf(after), LengthOf(before), 1e-9 * LengthOf(before));
  else
    EXPECT_GT(LengthOf(after), 0.9 * LengthOf(before));
}

// Triangles of a flat face lie in it: their corners do, and together they have its area.
class EveryFlatShape : public EverySharpShape {};
TEST_P(EveryFlatShape, KeepsItsFacesFlat) {
  const TriangleBvh surface(input.positions, input.triangles);
  for (const Vec3& p : out.mesh.positions)
    EXPECT_LT(std::sqrt(surface.FindClosestPoint(p)->squared_distance), 1e-12 * SizeOf(input));
  for (const Triangle& t : out.mesh.triangles) {
    const Vec3 middle = (out.mesh.PositionAt(t[0]) + out.mesh.PositionAt(t[1]) + out.mesh.PositionAt(t[2])) / 3.0;
    EXPECT_LT(std::sqrt(surface.FindClosestPoint(middle)->squared_distance), 1e-12 * SizeOf(input));
  }
  EXPECT_NEAR(AreaOf(out.mesh), AreaOf(input), 1e-9 * AreaOf(input));
  if (MeasureTopology(input).closed) {
    EXPECT_NEAR(VolumeOf(out.mesh), VolumeOf(input), 1e-9 * VolumeOf(input));
  }
}

#ifdef MESHFRONT_COARSE_ZOO
const std::vector<double> kRhos{1.0}, kEtas{1.2};
#else
const std::vector<double> kRhos{0.5, 1.0, 1.5}, kEtas{1.2, 1.5};
#endif
INSTANTIATE_TEST_SUITE_P(Shapes, EverySharpShape, Combine(ValuesIn(SharpShapes()), ValuesIn(kRhos), ValuesIn(kEtas)),
                         NameOfGridCase<SharpShape>);
INSTANTIATE_TEST_SUITE_P(Shapes, EveryFlatShape, Combine(ValuesIn(FlatShapes()), ValuesIn(kRhos), ValuesIn(kEtas)),
                         NameOfGridCase<SharpShape>);

TEST(RemeshCreases, KeepRoundFacesRoundUpToTheirEdge) {
  // On the wall of a cylinder nothing is as far off as the rounding of its edge would be.
  const TriangleMesh input = CappedCylinder(1, 2, 48, 8);
  const Outcome out = RemeshOrFail(input, {});
  for (const Vec3& p : out.mesh.positions) {
    const double off_wall = std::abs(std::hypot(p.x, p.y) - 1), off_cap = std::abs(std::abs(p.z) - 1);
    EXPECT_LT(std::min(off_wall, off_cap), out.report.error_bound);
  }
}

TEST(RemeshCreases, MayFadeOutInsideAFace) {
  // A plate with a fold whose two sides meet at 90° at x = -1, and lie in one plane from x = 0.3 on.
  const TriangleMesh input =
      Extruded(HeightField(30, [](double x, double y) { return -std::abs(y) * std::max(0.0, (0.3 - x) / 1.3); }), 0.5);
  for (const double rho : {0.3, 0.8, 1.5}) {
    RemeshOptions options;
    options.rho = rho;
    const Outcome out = RemeshOrFail(input, options);
    EXPECT_TRUE(out.report.complete);
    EXPECT_THAT(out.mesh,
                AllOf(IsManifold(), HasComponents(1), HasGenus(0), HasBoundaryLoops(0), HasNoSelfIntersection()));
    const TriangleBvh surface(out.mesh.positions, out.mesh.triangles);
    for (double x = -1; x < 0.1; x += 0.01) {
      for (const double z : {0.0, 0.5})
        EXPECT_LT(std::sqrt(surface.FindClosestPoint({x, 0, z})->squared_distance), 1e-12) << x;
    }
  }
}

TEST(RemeshCreases, HaveANormalWhereTheSurfaceFoldsBackOnItself) {
  // A sheet folded flat: along the fold the normals of both sides cancel out.
  const TriangleMesh folded = Mapped(Sheet(8), [](const Vec3& p) { return Vec3{p.x, std::abs(p.y), 0}; });
  const Outcome out = RemeshOrFail(folded, {});
  EXPECT_THAT(out.mesh, AllOf(IsManifold(), HasComponents(1), HasBoundaryLoops(1)));
}

TEST(RemeshCreases, AreTheSameAtAnyNumberOfThreads) {
  const TriangleMesh input = PlateWithRoundHole();
  const Outcome one = RemeshOrFail(input, {}, 1);
  for (const int threads : {2, 4}) {
    const Outcome many = RemeshOrFail(input, {}, threads);
    EXPECT_EQ(many.mesh.positions, one.mesh.positions) << threads;
    EXPECT_EQ(many.mesh.triangles, one.mesh.triangles) << threads;
  }
}

// [-1, 1]² × [0, 1] with its upright edges cut off: four strips, `width` wide.
TriangleMesh BeveledBox(double width) {
  const double cut = 1 - width / std::numbers::sqrt2;
  return Extruded(Fan({{cut, -1, 0},
                       {1, -cut, 0},
                       {1, cut, 0},
                       {cut, 1, 0},
                       {-cut, 1, 0},
                       {-1, cut, 0},
                       {-1, -cut, 0},
                       {-cut, -1, 0}}),
                  1);
}

TriangleMesh OpenRibbon(double width) {
  return Mapped(Sheet(8), [&](const Vec3& p) { return Vec3{p.x, 0.5 * width * p.y, 0}; });
}

struct StripShape {
  std::string name;
  TriangleMesh mesh;
  double least = 0.5;  // 2r/R of the worst half percent
};
std::vector<StripShape> StripShapes() {
  return {{"plate", Extruded(Sheet(4), 0.08)},
          {"plate of twelve triangles", Extruded(Sheet(1), 0.08)},
          {"beveled box", BeveledBox(0.08)},
          {"open ribbon", OpenRibbon(0.08), 0.3},  // its ends are shorter than an edge, and are kept
          {"washer",
           Extruded(Clipped(Sheet(60), [](const Vec3& p) { return std::abs(std::hypot(p.x, p.y) - 0.8) - 0.04; }), 1)}};
}

TEST(RemeshCreases, MakeGoodTrianglesOfStripsThatAreNarrowerThanAnEdge) {
  for (const auto& [name, mesh, least] : StripShapes()) {
    for (const double rho : {0.5, 1.0, 1.5}) {
      SCOPED_TRACE(name + " at " + std::to_string(rho));
      RemeshOptions options;
      options.rho = rho;
      const Outcome out = RemeshOrFail(mesh, options);
      EXPECT_TRUE(out.report.complete);
      EXPECT_EQ(MeasureTopology(out.mesh).closed, MeasureTopology(mesh).closed);
      EXPECT_GT(out.report.quality.radius_ratio_p0_5, least);
      EXPECT_GT(out.report.quality.radius_ratio_min, 0.3);
      EXPECT_NEAR(static_cast<double>(out.report.predicted_triangles) / out.report.output.triangles, 1, 0.12);
    }
  }
}

TEST(RemeshCreases, TakeNoThousandsOfTrianglesForAStripAsThinAsAHair) {
  for (const double width : {1e-1, 1e-2, 1e-3, 1e-4}) {
    EXPECT_LT(RemeshOrFail(Extruded(Sheet(4), width), {}).mesh.triangles.size(), 4000) << width;
    EXPECT_LT(RemeshOrFail(BeveledBox(width), {}).mesh.triangles.size(), 4000) << width;
  }
}

TEST(RemeshCreases, AreMetByTheNumberOfTrianglesWantedBesideStrips) {
  RemeshOptions options;
  for (const uint64_t count : {1000, 10000}) {
    options.target_triangles = count;
    options.sizing = Sizing::kError;
    const Report report =
        RemeshOrFail(Joined(BeveledBox(0.08), Moved(Torus(1, 0.4, 120, 48), {4, 0, 0})), options).report;
    EXPECT_NEAR(static_cast<double>(report.predicted_triangles) / static_cast<double>(count), 1, 0.01);
  }
}

TEST(RemeshCreases, KeepTheLengthAskedForBesideStrips) {
  RemeshOptions options;
  options.sizing = Sizing::kUniform;
  options.edge_length = Length{0.1, false};
  const TriangleMesh mesh = RemeshOrFail(BeveledBox(0.02), options).mesh;
  std::vector<Segment> edges =
      SegmentsOf(mesh, CreateAdjacency(mesh), std::vector<bool>(3 * mesh.triangles.size(), true));
  std::nth_element(edges.begin(), edges.begin() + edges.size() / 2, edges.end(),
                   [](const Segment& a, const Segment& b) { return Distance(a.from, a.to) < Distance(b.from, b.to); });
  EXPECT_NEAR(Distance(edges[edges.size() / 2].from, edges[edges.size() / 2].to), 0.1, 0.002);
}

TEST(RemeshCreases, AreRoundedOffWithoutAnAngle) {
  RemeshOptions options;
  const auto corners = [](const TriangleMesh& mesh) {
    return std::count_if(mesh.positions.begin(), mesh.positions.end(),
                         [](const Vec3& p) { return std::abs(p.x) == 1 && std::abs(p.y) == 1 && std::abs(p.z) == 1; });
  };
  const Outcome kept = RemeshOrFail(Cube(8), options);
  EXPECT_EQ(corners(kept.mesh), 8);
  EXPECT_NEAR(VolumeOf(kept.mesh), 8, 1e-9);
  options.crease_angle.reset();
  const Outcome rounded = RemeshOrFail(Cube(8), options);
  EXPECT_THAT(rounded.mesh, IsClosedManifold());
  EXPECT_LT(corners(rounded.mesh), 8);
  EXPECT_LT(VolumeOf(rounded.mesh), 8 - 1e-3);
  EXPECT_GT(rounded.mesh.triangles.size(), 2 * kept.mesh.triangles.size()) << "and are expensive then";
}

// Whether the front passes over the edges or they have to be kept: the mesh is whole.
class EverySharpShapeWithoutCreases : public ::testing::TestWithParam<std::tuple<SharpShape, double, double>> {};
TEST_P(EverySharpShapeWithoutCreases, KeepsItsTopologyAndDoesNotIntersectItself) {
  const TriangleMesh input = std::get<0>(GetParam()).make();
  RemeshOptions options;
  options.rho = std::get<1>(GetParam());
  options.eta = std::get<2>(GetParam());
  options.crease_angle = std::nullopt;
  const Outcome out = RemeshOrFail(input, options);
  const TopologyReport before = MeasureTopology(input);
  EXPECT_TRUE(out.report.complete);
  EXPECT_THAT(out.mesh, AllOf(IsManifold(), HasComponents(before.components), HasGenus(*before.genus),
                              HasBoundaryLoops(before.boundary_loops)));
  EXPECT_THAT(out.mesh, HasNoSelfIntersection());
}
INSTANTIATE_TEST_SUITE_P(Shapes, EverySharpShapeWithoutCreases,
                         Combine(ValuesIn(SharpShapes()), ::testing::Values(1.0), ::testing::Values(1.2, 1.7)),
                         NameOfGridCase<SharpShape>);

TEST(RemeshCreases, AreThoseThatTurnByMoreThanTheAngle) {
  // The walls of a prism of eight sides meet at 45°. How much of the upright edge through (1, 0) the output has as edges:
  const TriangleMesh prism = CappedCylinder(1, 2, 8, 6);
  const auto kept = [&](double angle) {
    RemeshOptions options;
    options.crease_angle = angle;
    const TriangleMesh mesh = RemeshOrFail(prism, options).mesh;
    const FaceAdjacency adjacency = CreateAdjacency(mesh);
    std::vector<Segment> edges = SegmentsOf(mesh, adjacency, std::vector<bool>(3 * mesh.triangles.size(), true));
    std::erase_if(edges, [](const Segment& s) { return DistanceTo({{1, 0, -1}, {1, 0, 1}}, s.from) > 1e-12; });
    std::erase_if(edges, [](const Segment& s) { return DistanceTo({{1, 0, -1}, {1, 0, 1}}, s.to) > 1e-12; });
    return LengthOf(edges);
  };
  EXPECT_NEAR(kept(44), 2, 1e-12);
  EXPECT_LT(kept(46), 1);
}

}  // namespace
}  // namespace meshfront::testing
