// Lines put into meshes: they are edges then, where they were asked for, and nothing else has moved.
#include "core/features/line_insertion.h"

#include <cmath>
#include <numbers>

#include "core/features/line_clipping.h"
#include "core/geometry/segment.h"
#include "core/geometry/triangle.h"
#include "core/mesh/topology.h"
#include "tests/support/matchers.h"
#include "tests/support/polylines.h"
#include "tests/support/shapes.h"
#include "tests/support/textured.h"

namespace meshfront::testing {
namespace {

constexpr auto kInvalid = absl::StatusCode::kInvalidArgument;

struct Split {
  TriangleMesh mesh;
  FaceAdjacency adjacency;
  std::vector<bool> creases;
  InsertedLines inserted;
  absl::Status status;

  double MarkedLength() const {
    double sum = 0;
    for (uint32_t h = 0; h < creases.size(); ++h) sum += creases[h] ? 0.5 * std::sqrt(SquaredLength(mesh, h)) : 0;
    return sum;
  }
  double DistanceToMarks(const Vec3& p) const {
    double least = 1e9;
    for (uint32_t h = 0; h < creases.size(); ++h) {
      if (creases[h]) least = std::min(least, Distance(mesh.PositionAt(OriginOf(mesh, h)), p));
    }
    return least;
  }
};

Split Insert(TriangleMesh mesh, const Polylines& lines) {
  Split split;
  split.mesh = std::move(mesh);
  split.adjacency = CreateAdjacency(split.mesh);
  split.creases.resize(3 * split.mesh.triangles.size());
  const auto inserted = InsertPolylines(lines, split.mesh, split.adjacency, split.creases, {});
  split.status = inserted.status();
  if (inserted.ok()) split.inserted = *inserted;
  return split;
}

double AreaOf(const TriangleMesh& mesh) {
  double sum = 0;
  for (const Triangle& t : mesh.triangles)
    sum += TriangleArea(mesh.PositionAt(t[0]), mesh.PositionAt(t[1]), mesh.PositionAt(t[2]));
  return sum;
}

// The middle third of a square sheet, but for the faces that touch the others: of a line from side to side what lies there, of others nothing.
TEST(Polylines, AreClippedToFacesAwayFromAllOthers) {
  const TriangleMesh sheet = Sheet(12);
  std::vector<bool> middle;
  for (const Triangle& t : sheet.triangles) {
    const double x = (sheet.PositionAt(t[0]).x + sheet.PositionAt(t[1]).x + sheet.PositionAt(t[2]).x) / 3;
    middle.push_back(std::abs(x) < 1.0 / 3);
  }
  Polylines lines = Line({{-1, -0.3, 0}, {1, 0.3, 0}, {1, 0.8, 0}});
  const ClippedLines clipped = ClipPolylines(lines, sheet, middle, 1);
  ASSERT_EQ(clipped.lines.segments.size(), 1u);
  const Vec3 &a = clipped.lines.points[clipped.lines.segments[0][0]],
             &b = clipped.lines.points[clipped.lines.segments[0][1]];
  EXPECT_NEAR(a.x, -1.0 / 6, 1e-6);
  EXPECT_NEAR(b.x, 1.0 / 6, 1e-6);
  EXPECT_EQ(clipped.origins, std::vector<uint32_t>{0});
  EXPECT_EQ(clipped.cut, (std::vector<uint32_t>{0, 1}));
}

// A line that would have to cross fixed faces is refused by the name it has, and splits none of them.
TEST(Polylines, LeaveFixedFacesAlone) {
  Split split;
  split.mesh = Sheet(8);
  split.adjacency = CreateAdjacency(split.mesh);
  split.creases.resize(3 * split.mesh.triangles.size());
  LineLimits limits;
  for (const Triangle& t : split.mesh.triangles) limits.fixed.push_back(split.mesh.PositionAt(t[0]).x > 0.5);
  limits.origins = {7};
  const auto inserted =
      InsertPolylines(Line({{0.1, 0.31, 0}, {0.9, 0.77, 0}}), split.mesh, split.adjacency, split.creases, {}, limits);
  EXPECT_THAT(inserted, StatusIs(kInvalid, "options.features.segments[7]"));
  for (size_t f = 0; f < limits.fixed.size(); ++f) {
    if (limits.fixed[f]) {
      EXPECT_EQ(split.mesh.triangles[f], Sheet(8).triangles[f]);
    }
  }
}

// A zigzag on a flat sheet: as long as it was asked for, through its points, and the sheet's area stays.
TEST(Polylines, AreEdgesOfAFlatMesh) {
  const TriangleMesh sheet = Sheet(7);
  const std::vector<Vec3> points = {{0.213, 0.117, 0}, {0.481, 0.733, 0}, {0.5, 0.25, 0}, {0.871, 0.642, 0}};
  const Split split = Insert(sheet, Line(points));
  ASSERT_THAT(split.status, IsOk());
  double length = 0;
  for (size_t i = 1; i < points.size(); ++i) length += Distance(points[i - 1], points[i]);
  EXPECT_NEAR(split.MarkedLength(), length, 1e-3);
  for (const Vec3& p : points) EXPECT_LE(split.DistanceToMarks(p), 1e-6);
  EXPECT_NEAR(AreaOf(split.mesh), AreaOf(sheet), 1e-12);
  EXPECT_TRUE(HasSingleFans(split.mesh, split.adjacency));
  EXPECT_EQ(split.inserted.split_faces, split.mesh.triangles.size() - sheet.triangles.size());
  EXPECT_EQ(split.inserted.moved_points, 0u);
  for (uint32_t h = 0; h < split.creases.size(); ++h) {
    const uint32_t across = split.adjacency.OppositeOf(h);
    if (across != kNoHalfEdge) {
      EXPECT_EQ(split.creases[h], split.creases[across]);
    }
  }
}

// The diagonal of the sheet's squares is there already.
TEST(Polylines, SplitNothingWhereEdgesAreThere) {
  TriangleMesh sheet = Sheet(4);
  const Vec3 a = sheet.PositionAt(sheet.triangles[0][0]), b = sheet.PositionAt(sheet.triangles[0][1]);
  const Split split = Insert(sheet, Line({a, b}));
  ASSERT_THAT(split.status, IsOk());
  EXPECT_EQ(split.inserted.split_faces, 0u);
}

// Three chords that lie below the surface of a ball by up to 0.04: the line runs over it.
TEST(Polylines, FollowTheSurfaceBetweenTheirPoints) {
  std::vector<Vec3> points;
  for (int i = 0; i <= 8; ++i) {
    const double angle = std::numbers::pi * i / 8 - 0.3;
    points.push_back({std::cos(angle), std::sin(angle) * 0.8, std::sin(angle) * 0.6});
  }
  const TriangleMesh ball = Icosphere(3);
  const Split split = Insert(ball, Line(points));
  ASSERT_THAT(split.status, IsOk());
  EXPECT_NEAR(split.MarkedLength(), std::numbers::pi, 0.02);
  EXPECT_EQ(split.inserted.moved_points, 9u) << "between the vertices the faces lie below the ball";
  EXPECT_NEAR(AreaOf(split.mesh), AreaOf(ball), 1e-9);
  EXPECT_THAT(split.mesh, IsClosedManifold());
}

// A line over the edge of a cube is one chain across it, which divides the edge.
TEST(Polylines, GoAroundSharpEdges) {
  const TriangleMesh cube = Cube(2);
  const Split split = Insert(cube, Line({{0.3, 0.7, 1}, {1, 0.6, 1}, {1, 0.45, 0.2}}));
  ASSERT_THAT(split.status, IsOk()) << split.status;
  EXPECT_THAT(split.mesh, IsClosedManifold());
  EXPECT_GT(split.MarkedLength(), 1.3);
}

TEST(Polylines, MeetInOneVertexWhereTheyCross) {
  Polylines cross = Line({{0.2, 0.31, 0}, {0.8, 0.32, 0}});
  cross.points.push_back({0.51, 0.1, 0}), cross.points.push_back({0.52, 0.9, 0});
  cross.segments.push_back({2, 3});
  const Split split = Insert(Sheet(6), cross);
  ASSERT_THAT(split.status, IsOk());
  std::vector<int> ends(split.mesh.positions.size());
  for (uint32_t h = 0; h < split.creases.size(); ++h) {
    if (split.creases[h]) ++ends[OriginOf(split.mesh, h).index()];
  }
  EXPECT_EQ(std::count(ends.begin(), ends.end(), 4), 1);
  EXPECT_EQ(std::count(ends.begin(), ends.end(), 1), 4);
  EXPECT_EQ(std::count(ends.begin(), ends.end(), 3), 0);
}

TEST(Polylines, TakeAttributesAndGroupsAlong) {
  TriangleMesh sheet = Textured(Sheet(5), [](const Vec3& p, const Vec3&) {
    return std::array<double, 2>{2 * p.x, p.y};
  });
  for (size_t f = 0; f < sheet.triangles.size(); ++f) sheet.attributes.groups.push_back(f % 3);
  const Split split = Insert(sheet, Line({{0.213, 0.117, 0}, {0.481, 0.733, 0}}));
  ASSERT_THAT(split.status, IsOk());
  ASSERT_THAT(ValidateAttributes(split.mesh.attributes, split.mesh.triangles.size()), IsOk());
  for (size_t f = 0; f < split.mesh.triangles.size(); ++f) {
    for (int i = 0; i < 3; ++i) {
      const Vec3& p = split.mesh.PositionAt(split.mesh.triangles[f][i]);
      const auto values = split.mesh.attributes.WedgeAt(split.mesh.attributes.corners[f][i]);
      EXPECT_NEAR(values[0], 2 * p.x, 1e-5);
      EXPECT_NEAR(values[1], p.y, 1e-5);
    }
  }
}

TEST(Polylines, AreRefusedWhereTheSurfaceIsNot) {
  EXPECT_THAT(Insert(Sheet(4), Line({{0.2, 0.2, 0}, {0.4, 0.4, 0}, {0.5, 0.5, 0.1}})).status,
              StatusIs(kInvalid, "options.features.segments[1] lies at 0.5, 0.5, 0.1"));
  // Over the hole of a plate.
  EXPECT_THAT(Insert(PlateWithRoundHole(), Line({{-0.9, 0.1, 0.3}, {0.9, 0.1, 0.3}})).status,
              StatusIs(kInvalid, "options.features.segments[0]"));
  Polylines wrong = Line({{0, 0, 0}, {1, 0, 0}});
  wrong.segments.push_back({0, 2});
  EXPECT_THAT(ValidatePolylines(wrong), StatusIs(kInvalid, "options.features.segments[1] names point 2"));
  wrong.points[1].x = NAN;
  EXPECT_THAT(ValidatePolylines(wrong), StatusIs(kInvalid, "options.features.points[1]"));
}

}  // namespace
}  // namespace meshfront::testing
