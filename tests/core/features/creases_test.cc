#include "core/features/creases.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <functional>
#include <numbers>
#include <utility>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/support/rounded_shapes.h"
#include "tests/support/shapes.h"
#include "tests/support/sharp_edges.h"
#include "tests/support/slivers.h"

namespace meshfront {
namespace {

using ::testing::AllOf;
using ::testing::Each;
using ::testing::Field;
using ::testing::Ge;
using ::testing::IsEmpty;
using testing::Segment;
using ::testing::SizeIs;

constexpr double kDegree = std::numbers::pi / 180;

// The creases of a mesh, each edge once; both of its halves must say so.
std::vector<Segment> CreasesOf(const TriangleMesh& mesh, double degrees = 40) {
  const FaceAdjacency adjacency = CreateAdjacency(mesh);
  const auto creases = FindCreases(mesh, adjacency, degrees * kDegree, {});
  EXPECT_TRUE(creases.ok()) << creases.status();
  for (uint32_t h = 0; h < creases->size(); ++h) {
    const uint32_t across = adjacency.OppositeOf(h);
    if (!(*creases)[h]) continue;
    EXPECT_NE(across, kNoHalfEdge) << "a rim is no crease";
    EXPECT_TRUE(across == kNoHalfEdge || (*creases)[across]) << "the other half";
  }
  return testing::SegmentsOf(mesh, adjacency, *creases);
}

MATCHER(IsOnAnEdgeOfTheCube, "") {
  const auto is_on_two_faces = [](const Vec3& p) {
    return (std::abs(p.x) == 1) + (std::abs(p.y) == 1) + (std::abs(p.z) == 1) >= 2;
  };
  return is_on_two_faces(arg.from) && is_on_two_faces(arg.to) && is_on_two_faces(0.5 * (arg.from + arg.to));
}

// A sheet of n × n squares with ridges: vertices where `slope` is not 0 are raised by that part of an edge, so that the sheet
// turns by atan(slope) at the foot and by twice that at the top.
TriangleMesh Ridges(int n, const std::function<double(double x, double y)>& slope) {
  return testing::HeightField(n, [&](double x, double y) { return 2.0 / n * slope(x, y); });
}
// The slope of a ridge whose two sides meet at this angle.
double SlopeOf(double degrees) { return std::tan(0.5 * degrees * kDegree); }
bool IsZero(double x) { return std::abs(x) < 1e-9; }

TEST(FindCreases, AreTheTwelveEdgesOfACube) {
  for (const int n : {1, 2, 7}) {
    const auto creases = CreasesOf(testing::Cube(n));
    EXPECT_THAT(creases, SizeIs(12 * n)) << "the squares' diagonals are none";
    EXPECT_THAT(creases, Each(IsOnAnEdgeOfTheCube()));
  }
}

TEST(FindCreases, AreNoneOnASmoothSurface) {
  EXPECT_THAT(CreasesOf(testing::Icosphere(3)), IsEmpty());
  EXPECT_THAT(CreasesOf(testing::Torus(1, 0.4, 40, 24)), IsEmpty());
}

TEST(FindCreases, TurnByMoreThanTheAngle) {
  // A prism's walls turn by 360° / n from one to the next, and by 90° to its caps.
  for (const int n : {5, 6, 8, 12, 20}) {
    const double turn = 360.0 / n;
    const TriangleMesh prism = testing::CappedCylinder(1, 2, n, 1);
    EXPECT_THAT(CreasesOf(prism, turn - 0.01), SizeIs(3 * n)) << n;
    EXPECT_THAT(CreasesOf(prism, turn + 0.01), SizeIs(2 * n)) << n;
    EXPECT_THAT(CreasesOf(prism, 90.01), IsEmpty()) << n;
  }
}

TEST(FindCreases, BridgeAGapOfAFewWeakerEdges) {
  // A ridge of 60° across the whole sheet, of 30° for `gap` of its 40 edges.
  for (const int gap : {2, 6}) {
    const auto ridge = [=](double x, double y) {
      return !IsZero(y) ? 0 : SlopeOf(std::abs(x) < 0.025 * gap - 1e-9 ? 30 : 60);
    };
    EXPECT_THAT(CreasesOf(Ridges(40, ridge)), SizeIs(40)) << gap;
  }
}

TEST(FindCreases, EndAtALongGapOfWeakerEdges) {
  // What is left, of 7 edges, leads nowhere.
  const auto ridge = [](double x, double y) { return !IsZero(y) ? 0 : SlopeOf(std::abs(x) < 0.69 ? 30 : 60); };
  EXPECT_THAT(CreasesOf(Ridges(40, ridge)), IsEmpty());
}

TEST(FindCreases, DoNotBridgeAGapWithoutATurn) {
  const auto ridge = [](double x, double y) { return !IsZero(y) || std::abs(x) < 0.09 ? 0 : SlopeOf(60); };
  EXPECT_THAT(CreasesOf(Ridges(40, ridge)), IsEmpty());
}

TEST(FindCreases, LeaveOutALineThatEndsInsideAPatch) {
  const auto half = [](double x, double y) { return !IsZero(y) || x < 0.2 ? 0 : SlopeOf(60); };
  EXPECT_THAT(CreasesOf(Ridges(40, half)), IsEmpty()) << "from the rim inwards";
  const auto inner = [](double x, double y) { return !IsZero(y) || std::abs(x) > 0.5 ? 0 : SlopeOf(60); };
  EXPECT_THAT(CreasesOf(Ridges(40, inner)), IsEmpty()) << "with two free ends, however long";
}

TEST(FindCreases, LeaveOutABranchThatEndsInsideAPatch) {
  const auto with_branch = [](double x, double y) {
    return IsZero(y) || (IsZero(x) && y > 0 && y < 0.34) ? SlopeOf(60) : 0;
  };
  const auto creases = CreasesOf(Ridges(40, with_branch));
  EXPECT_THAT(creases, SizeIs(40));
  for (const Segment& s : creases) EXPECT_NEAR(std::abs(s.from.y) + std::abs(s.to.y), 0, 1e-12);
}

// A plate of n × n squares whose top is folded along y = 0, by `turn`(x) degrees.
TriangleMesh FoldedPlate(int n, const std::function<double(double x)>& turn) {
  return testing::Extruded(
      testing::HeightField(n, [&](double x, double y) { return -std::abs(y) * SlopeOf(std::max(0.0, turn(x))); }), 0.5);
}
// Those of its creases that are on the fold.
std::vector<Segment> CreasesOnFold(const TriangleMesh& plate) {
  std::vector<Segment> creases = CreasesOf(plate);
  std::erase_if(creases, [](const Segment& s) {
    return std::max(std::abs(s.from.y), std::abs(s.to.y)) > 0.045 || std::abs(s.from.x) + std::abs(s.to.x) == 2 ||
           s.from.z < s.to.z - 0.4 || s.to.z < s.from.z - 0.4;
  });
  return creases;
}

TEST(FindCreases, FadeOutInsideAPatchWhereTheyComeALongWay) {
  for (const double end : {0.0, 0.5}) {
    const auto turn = [&](double x) { return 90 * (end - x) / (end + 1); };
    const auto creases = CreasesOnFold(FoldedPlate(40, turn));
    double farthest = -1;
    for (const Segment& s : creases) farthest = std::max({farthest, s.from.x, s.to.x});
    EXPECT_THAT(creases, SizeIs(2 * std::lround(20 * (farthest + 1)))) << "on the top and the bottom";
    EXPECT_NEAR(turn(farthest), 10, 7) << end;
  }
}

TEST(FindCreases, DoNotFadeOutAtBothEnds) {
  EXPECT_THAT(CreasesOnFold(FoldedPlate(40, [](double x) { return 150 * (0.5 - x * x); })), IsEmpty());
}

TEST(FindCreases, AreNoZigzagThatEndsInsideAPatch) {
  const auto zigzag = [](double aside) {
    return testing::Mapped(FoldedPlate(40, [](double x) { return -90 * x; }), [&](const Vec3& p) {
      if (!IsZero(p.y) || std::abs(p.x) == 1) return p;
      return Vec3{p.x, std::lround(20 * (p.x + 1)) % 2 == 0 ? aside : -aside, p.z};
    });
  };
  EXPECT_THAT(CreasesOnFold(zigzag(0.002)), SizeIs(Ge(16)));
  EXPECT_THAT(CreasesOnFold(zigzag(0.01)), IsEmpty());
}

TEST(FindCreases, AreFaintLinesFromCreaseToCrease) {
  const auto bent = [](int n, double degrees) {
    return testing::Mapped(testing::Cube(n), [=](const Vec3& p) {
      return Vec3{p.x, p.y, p.z - 0.5 * (1 + p.z) * SlopeOf(degrees) * std::abs(p.y)};
    });
  };
  EXPECT_THAT(CreasesOf(bent(8, 18)), SizeIs(12 * 8 + 8));
  EXPECT_THAT(CreasesOf(bent(8, 9)), SizeIs(12 * 8)) << "fainter than a quarter of the angle";
  EXPECT_THAT(CreasesOf(bent(2, 18)), SizeIs(12 * 2)) << "of two edges";
}

TEST(FindCreases, AreNotTheFacetsOfACylinder) {
  for (const int rows : {1, 4, 12}) EXPECT_THAT(CreasesOf(testing::CappedCylinder(1, 2, 20, rows)), SizeIs(2 * 20));
}

TEST(FindCreases, MayEndOnTheRimOfASheet) {
  const auto across = [](double, double y) { return IsZero(y) ? SlopeOf(60) : 0; };
  EXPECT_THAT(CreasesOf(Ridges(40, across)), SizeIs(40));
  const auto crossing = [](double x, double y) { return IsZero(y) || IsZero(x) ? SlopeOf(60) : 0; };
  EXPECT_THAT(CreasesOf(Ridges(40, crossing)), SizeIs(80));
}

TEST(FindCreases, LeaveOutASpikeOnAFineSphere) {
  TriangleMesh mesh = testing::Icosphere(4);  // edges of about 0.07
  mesh.positions[1000] *= 1.15;
  const auto sharp = testing::SharpEdges(mesh, CreateAdjacency(mesh));
  ASSERT_GT(std::count(sharp.begin(), sharp.end(), true), 6);
  EXPECT_THAT(CreasesOf(mesh), IsEmpty());
}

TEST(FindCreases, LeaveOutASpeckOfNoiseOnAFineSphere) {
  TriangleMesh mesh = testing::Icosphere(4);
  const TriangleMesh noisy = testing::WithNoise(mesh, 0.04, 3);
  for (size_t v = 0; v < mesh.positions.size(); ++v) {
    if (Distance(mesh.positions[v], {0, 0, 1}) < 0.2) mesh.positions[v] = noisy.positions[v];
  }
  const auto sharp = testing::SharpEdges(mesh, CreateAdjacency(mesh));
  ASSERT_GT(std::count(sharp.begin(), sharp.end(), true), 20);
  EXPECT_THAT(CreasesOf(mesh), IsEmpty());
}

TEST(FindCreases, LeaveOutALargeSpeckOfNoise) {
  // Patches of a few faces each, that touch: more than 40 faces in all.
  TriangleMesh mesh = testing::Icosphere(5);
  const TriangleMesh noisy = testing::WithNoise(mesh, 0.02, 3);
  for (size_t v = 0; v < mesh.positions.size(); ++v) {
    if (Distance(mesh.positions[v], {0, 0, 1}) < 0.17) mesh.positions[v] = noisy.positions[v];
  }
  const auto sharp = testing::SharpEdges(mesh, CreateAdjacency(mesh));
  ASSERT_GT(std::count(sharp.begin(), sharp.end(), true), 100);
  EXPECT_THAT(CreasesOf(mesh), IsEmpty());
}

TEST(FindCreases, LeaveOutASpikeOnASmallPatch) {
  // The six patches of 450 faces touch: looked at together they have no patch around them.
  TriangleMesh cube = testing::Cube(15);
  for (Vec3& p : cube.positions) {
    if (Distance(p, {-1.0 / 15, 1.0 / 15, 1}) < 1e-9) p.z += 0.3;
  }
  EXPECT_THAT(CreasesOf(cube), SizeIs(12 * 15));
}

// A plate of 20 × 20 squares, 0.1 wide; one of them holds a smaller square with a pyramid of four faces on it.
TriangleMesh PlateWithPyramid(double base) {
  TriangleMesh mesh = testing::Sheet(20);
  std::vector<VertexId> corners, feet;
  const Vec3 middle{0.05, 0.05, 0};
  std::erase_if(mesh.triangles, [&](const Triangle& t) {
    const Vec3 c = (mesh.PositionAt(t[0]) + mesh.PositionAt(t[1]) + mesh.PositionAt(t[2])) / 3.0;
    return std::max(std::abs(c.x - middle.x), std::abs(c.y - middle.y)) < 0.05;
  });
  for (const Vec3& d : {Vec3{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}}) {
    for (uint32_t v = 0; v < 441; ++v) {
      if (Distance(mesh.positions[v], middle + 0.05 * d) < 1e-9) corners.push_back(VertexId(v));
    }
    feet.push_back(VertexId(mesh.positions.size()));
    mesh.positions.push_back(middle + 0.5 * base * d);
  }
  const VertexId top(mesh.positions.size());
  mesh.positions.push_back(middle + Vec3{0, 0, 0.5 * base});
  for (int i = 0; i < 4; ++i) {
    const int j = (i + 1) % 4;
    mesh.triangles.push_back({corners[i], corners[j], feet[j]});
    mesh.triangles.push_back({corners[i], feet[j], feet[i]});
    mesh.triangles.push_back({feet[i], feet[j], top});
  }
  return mesh;
}

TEST(FindCreases, KeepASmallPyramidOnACoarsePlate) {
  // Much finer than what is around it: somebody meant it. Four edges at the foot, four to the top.
  EXPECT_THAT(CreasesOf(PlateWithPyramid(0.012)), SizeIs(8));
  EXPECT_THAT(CreasesOf(PlateWithPyramid(0.09)), IsEmpty()) << "as coarse as the plate it may be noise";
}

// A plate of 20 × 20 squares, 0.1 wide, of which one is `depth` deeper; its wall is of two faces a side.
TriangleMesh PlateWithPocket(double depth) {
  TriangleMesh mesh = testing::Sheet(20);
  std::vector<uint32_t> lower(mesh.positions.size(), 0);
  const auto is_floor = [&](const Triangle& t) {
    const Vec3 c = (mesh.PositionAt(t[0]) + mesh.PositionAt(t[1]) + mesh.PositionAt(t[2])) / 3.0;
    return std::abs(c.x - 0.05) < 0.05 && std::abs(c.y - 0.05) < 0.05;
  };
  std::vector<std::array<VertexId, 2>> sides;
  for (Triangle& t : mesh.triangles) {
    if (!is_floor(t)) continue;
    const Triangle upper = t;
    for (VertexId& v : t) {
      uint32_t& name = lower[v.index()];
      if (name == 0) {
        name = static_cast<uint32_t>(mesh.positions.size());
        mesh.positions.push_back(mesh.PositionAt(v) - Vec3{0, 0, depth});
      }
      v = VertexId(name);
    }
    for (int i = 0; i < 3; ++i) {
      const VertexId a = upper[i], b = upper[(i + 1) % 3];
      const Vec3 d = mesh.PositionAt(b) - mesh.PositionAt(a);
      if (std::abs(d.x * d.y) < 1e-9) sides.push_back({a, b});
    }
  }
  for (const auto& [a, b] : sides) {
    const VertexId low_a(lower[a.index()]), low_b(lower[b.index()]);
    mesh.triangles.push_back({a, b, low_b});
    mesh.triangles.push_back({a, low_b, low_a});
  }
  return mesh;
}

// Ten faces with corners in a patch of eight hundred; a spike has as many.
TEST(FindCreases, KeepAPocketInAFlatFace) {
  EXPECT_THAT(CreasesOf(PlateWithPocket(0.05)), SizeIs(12));
  EXPECT_THAT(CreasesOf(PlateWithPocket(-0.05)), SizeIs(12)) << "and a boss";
  TriangleMesh bent = testing::Mapped(PlateWithPocket(0.05), [](const Vec3& p) {
    return p + Vec3{0, 0, 0.2 * p.x * p.x + 0.1 * p.y * p.y};
  });
  EXPECT_THAT(CreasesOf(bent), IsEmpty()) << "on a scan it may be noise";
}

TriangleMesh TurnedAndMoved(const TriangleMesh& mesh, double far) {
  return testing::Moved(testing::Rotated(mesh, {0.3, 0.5, 0.8}, 0.7), {far, -2 * far, far});
}

// Faces 0.1 wide, and far from the origin few digits for them.
TEST(FindCreases, KeepAPocketWhoseCoordinatesAreRounded) {
  for (const double depth : {0.05, -0.05}) {
    const TriangleMesh plate = PlateWithPocket(depth);
    EXPECT_THAT(CreasesOf(testing::AsWritten(TurnedAndMoved(plate, 10), "%.6g")), SizeIs(12));
    EXPECT_THAT(CreasesOf(testing::AsWritten(TurnedAndMoved(plate, 10), "%.4f")), SizeIs(12));
    EXPECT_THAT(CreasesOf(testing::AsFloats(TurnedAndMoved(plate, 1000))), SizeIs(12));
  }
  // The same bumps with more digits, so that they are none of rounding.
  const TriangleMesh rough =
      testing::Scaled(testing::AsWritten(TurnedAndMoved(PlateWithPocket(0.05), 10), "%.6g"), 1.1 / 7);
  EXPECT_THAT(CreasesOf(rough), IsEmpty());
}

// A sheet with narrow strips in it, which rounding turns by up to 50 degrees.
TEST(FindCreases, AreNotMadeByRounding) {
  const TriangleMesh strips = testing::Mapped(testing::Sheet(32), [](const Vec3& p) {
    const double column = std::round((p.x + 1) * 16), pair = std::floor(column / 2);
    return Vec3{pair * 0.1 + (column > 2 * pair ? 0.004 : 0.0), p.y, p.z};
  });
  EXPECT_THAT(CreasesOf(TurnedAndMoved(strips, 10)), IsEmpty());
  for (const char* format : {"%.5g", "%.3f"})
    EXPECT_THAT(CreasesOf(testing::AsWritten(TurnedAndMoved(strips, 10), format)), IsEmpty()) << format;
}

TEST(FindCreases, AreNotMadeByDegenerateFaces) {
  // A third vertex on a face's side, off by less than anything: the cap between the two has a normal of its own.
  for (const double off : {0.0, 1e-9, -1e-6}) {
    TriangleMesh sheet = testing::Sheet(4);
    const Triangle t = sheet.triangles[9];
    const VertexId m(sheet.positions.size());
    sheet.positions.push_back(0.5 * (sheet.PositionAt(t[0]) + sheet.PositionAt(t[1])) + Vec3{0, 0, off});
    sheet.triangles[9] = {t[0], t[1], m};
    sheet.triangles.push_back({m, t[1], t[2]});
    sheet.triangles.push_back({m, t[2], t[0]});
    EXPECT_THAT(CreasesOf(sheet), IsEmpty()) << off;
  }
}

TEST(FindCreases, RunAroundADegenerateFaceOnAnEdge) {
  // The same on a cube's edge: the crease is whole, on one side of the cap or the other.
  TriangleMesh cube = testing::Cube(1);
  const FaceAdjacency adjacency = CreateAdjacency(cube);
  const auto sharp = testing::SharpEdges(cube, adjacency);
  const auto h = static_cast<uint32_t>(std::find(sharp.begin(), sharp.end(), true) - sharp.begin());
  const VertexId a = OriginOf(cube, h), b = TargetOf(cube, h), c = OriginOf(cube, PreviousHalfEdge(h));
  const VertexId m(cube.positions.size());
  cube.positions.push_back(0.5 * (cube.PositionAt(a) + cube.PositionAt(b)));
  cube.triangles[FaceOfHalfEdge(h)] = {a, b, m};
  cube.triangles.push_back({m, b, c});
  cube.triangles.push_back({m, c, a});
  const auto creases = CreasesOf(cube);
  EXPECT_THAT(creases, Each(IsOnAnEdgeOfTheCube()));
  double length = 0;
  for (const Segment& s : creases) length += Distance(s.from, s.to);
  EXPECT_NEAR(length, 24, 1e-12);
}

TEST(FindCreases, StopWhenTheContextSaysSo) {
  const std::atomic<bool> stop = true;
  Context context;
  context.stop = &stop;
  const TriangleMesh cube = testing::Cube(2);
  EXPECT_EQ(FindCreases(cube, CreateAdjacency(cube), 1, context).status().code(), absl::StatusCode::kCancelled);
}

// A sheet with a step from rim to rim: needles that stand upright between faces that agree.
TEST(FindCreases, AreNotTheSidesOfAHairBetweenFacesThatAgree) {
  const auto step = [](double height) {
    return testing::Mapped(testing::HeightField(10, [](double, double) { return 0.0; }), [&](const Vec3& p) {
      return Vec3{p.x > 0.1 && p.x < 0.3 ? 0 : p.x, p.y, p.x > 0.1 ? height : 0};
    });
  };
  EXPECT_THAT(CreasesOf(step(1e-4)), IsEmpty());
  EXPECT_THAT(CreasesOf(step(1e-2)), SizeIs(20)) << "this is a step";
}

TEST(FindCreases, NeedlesOnASmoothSurfaceAreNone) {
  EXPECT_THAT(CreasesOf(testing::WithNeedles(testing::Icosphere(5), 0.005, 1)), IsEmpty());
}

}  // namespace
}  // namespace meshfront
