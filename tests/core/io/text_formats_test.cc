// OFF, OBJ and XYZ: what is peculiar to each.
#include <cmath>
#include <limits>

#include "core/io/mesh_io.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/core/io/support.h"
#include "tests/support/matchers.h"

namespace meshfront {
namespace {

using absl::StatusCode;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::IsOk;
using testing::ReadText;
using ::testing::SizeIs;
using testing::StatusIs;

TriangleMesh MeshOf(const std::string& text, Format format) {
  const auto read = ReadText(text, format);
  EXPECT_THAT(read, IsOk());
  return read.ok() ? read->mesh : TriangleMesh();
}

double Area(const TriangleMesh& mesh, const Triangle& t) {
  return 0.5 *
         Norm(Cross(mesh.PositionAt(t[1]) - mesh.PositionAt(t[0]), mesh.PositionAt(t[2]) - mesh.PositionAt(t[0])));
}
double Area(const TriangleMesh& mesh) {
  double area = 0;
  for (const Triangle& t : mesh.triangles) area += Area(mesh, t);
  return area;
}

// --- OFF ----------------------------------------------------------------------------------------------------------------

TEST(Off, TakesCountsOnTheFirstLineAndNoEdges) {
  EXPECT_THAT(MeshOf("OFF 3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n", Format::kOff).triangles, SizeIs(1));
  EXPECT_THAT(MeshOf("OFF\n3 1\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2", Format::kOff).triangles, SizeIs(1));
  EXPECT_THAT(MeshOf("3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2", Format::kOff).triangles, SizeIs(1));
}

TEST(Off, PassesCommentsBlankLinesAndOldLineEnds) {
  EXPECT_THAT(MeshOf("# made by hand\n\nOFF # word\r\n3 1 0\r\n# a\r\n0 0 0\r\n\r\n1 0 0 # b\r\n0 1 0\r\n3 0 1 2\r\n",
                     Format::kOff)
                  .triangles,
              SizeIs(1));
  EXPECT_THAT(MeshOf("OFF\r3 1 0\r0 0 0\r1 0 0\r0 1 0\r3 0 1 2\r", Format::kOff).triangles, SizeIs(1));
}

TEST(Off, LeavesColoursAndTextureCoordinatesBehindAndSaysSo) {
  const TriangleMesh coff = MeshOf(
      "COFF\n3 1 0\n0 0 0 255 0 0 255\n1 0 0 0 255 0 255\n0 1 0 0 0 255 255\n3 0 1 2 0.5 0.5 0.5\n", Format::kOff);
  EXPECT_THAT(coff.dropped_attributes, ::testing::UnorderedElementsAre("color", "face color"));
  const TriangleMesh stoff = MeshOf("STOFF\n3 1 0\n0 0 0 0 0\n1 0 0 1 0\n0 1 0 0 1\n3 0 1 2\n", Format::kOff);
  EXPECT_THAT(stoff.dropped_attributes, Contains("texcoord_0"));
}

TEST(Off, KeepsNormalsOfPointsAndScalesThemToLengthOne) {
  const TriangleMesh points = MeshOf("NOFF\n2 0 0\n0 0 0 0 0 5\n1 0 0 1e200 0 0\n", Format::kOff);
  ASSERT_THAT(points.normals, SizeIs(2));
  EXPECT_EQ(points.normals[0], (Vec3{0, 0, 1}));
  EXPECT_EQ(points.normals[1], (Vec3{1, 0, 0}));
}

TEST(Off, RefusesOtherDimensionsAndBinary) {
  EXPECT_THAT(ReadText("nOFF\n4\n1 0 0\n0 0 0 0\n"), StatusIs(StatusCode::kInvalidArgument, "line 1: \"nOFF\""));
  EXPECT_THAT(ReadText("4OFF\n1 0 0\n0 0 0 1\n"), StatusIs(StatusCode::kInvalidArgument, "\"4OFF\""));
  EXPECT_THAT(ReadText(std::string("OFF BINARY\n\0\0\0\1", 15)),
              StatusIs(StatusCode::kInvalidArgument, "binary OFF is not read"));
}

TEST(Off, SkipsFacesOfFewerThanThreeCornersWithAWarning) {
  const auto read = ReadText("OFF\n3 4 0\n0 0 0\n1 0 0\n0 1 0\n0\n1 0\n2 0 1\n3 0 1 2\n");
  ASSERT_THAT(read, IsOk());
  EXPECT_THAT(read->mesh.triangles, SizeIs(1));
  EXPECT_THAT(read->warnings, Contains(HasSubstr("3 faces of fewer than three corners")));
}

TEST(Off, SaysWhichLineIsWrong) {
  EXPECT_THAT(ReadText("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 7\n"),
              StatusIs(StatusCode::kInvalidArgument, "test: line 6: face 0 names vertex 7; the vertices are 0 to 2"));
  EXPECT_THAT(ReadText("OFF\n3 1 0\n0 0 0\n1 0,5 0\n0 1 0\n3 0 1 2\n"),
              StatusIs(StatusCode::kInvalidArgument, "test: line 4: vertex 1 has \"0,5\", not a number"));
  EXPECT_THAT(ReadText("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2.5\n"),
              StatusIs(StatusCode::kInvalidArgument, "line 6"));
}

TEST(Off, ReadsNumbersOfEveryKind) {
  const TriangleMesh mesh = MeshOf("OFF\n2 0 0\n+1 -.5 1e400\n1E-400 nan -inf\n", Format::kOff);
  ASSERT_THAT(mesh.positions, SizeIs(2));
  EXPECT_EQ(mesh.positions[0].x, 1);
  EXPECT_EQ(mesh.positions[0].y, -0.5);
  EXPECT_EQ(mesh.positions[0].z, std::numeric_limits<double>::infinity());
  EXPECT_EQ(mesh.positions[1].x, 0);
  EXPECT_TRUE(std::isnan(mesh.positions[1].y));
  EXPECT_EQ(mesh.positions[1].z, -std::numeric_limits<double>::infinity());
}

TEST(Off, NeverTrustsACount) {
  EXPECT_THAT(ReadText("OFF\n4000000000 1 0\n0 0 0\n"), StatusIs(StatusCode::kInvalidArgument, "only"));
  EXPECT_THAT(ReadText("OFF\n1 4000000000 0\n0 0 0\n"), StatusIs(StatusCode::kInvalidArgument, "only"));
  EXPECT_THAT(ReadText("OFF\n1 1 0\n0 0 0\n1000000000 0\n"),
              StatusIs(StatusCode::kInvalidArgument, "1000000000 corners"));
  EXPECT_THAT(ReadText("OFF\n99999999999999999999 1 0\n"), StatusIs(StatusCode::kInvalidArgument, "64 bits"));
}

// --- Polygons -----------------------------------------------------------------------------------------------------------

TEST(Polygons, AConcaveOneIsCutInsideItself) {
  // An arrow head: a fan from the first corner would fold over.
  const TriangleMesh arrow = MeshOf("OFF\n4 1 0\n0 0 0\n2 -1 0\n0 3 0\n-2 -1 0\n4 3 0 1 2\n", Format::kOff);
  EXPECT_THAT(arrow.triangles, SizeIs(2));
  EXPECT_NEAR(Area(arrow), 6, 1e-12);  // 8 of the hull less 2 of the notch
}

TEST(Polygons, AStarOfManyPointsKeepsItsAreaInAnyPlane) {
  std::string text = "OFF\n200 1 0\n";
  double area = 0;
  for (int i = 0; i < 200; ++i) {
    const double r = i % 2 ? 1 : 3, angle = i * 3.14159265358979323846 / 100;
    text += std::to_string(r * std::cos(angle)) + " " + std::to_string(r * std::sin(angle)) + " " +
            std::to_string(r * std::cos(angle)) + "\n";
    area += 0.5 * 3 * 1 * std::sin(3.14159265358979323846 / 100);
  }
  text += "200";
  for (int i = 0; i < 200; ++i) text += " " + std::to_string(i);
  const TriangleMesh star = MeshOf(text + "\n", Format::kOff);
  EXPECT_THAT(star.triangles, SizeIs(198));
  EXPECT_NEAR(Area(star), area * std::sqrt(2.0), 1e-4);
}

TEST(Polygons, OneThatCutsItselfOrIsHugeStillEnds) {
  std::string text = "OFF\n4000 1 0\n";
  for (int i = 0; i < 4000; ++i)
    text += std::to_string((i * 7919) % 4001) + " " + std::to_string((i * 104729) % 3989) + " 0\n";
  text += "4000";
  for (int i = 0; i < 4000; ++i) text += " " + std::to_string(i);
  EXPECT_THAT(MeshOf(text + "\n", Format::kOff).triangles, SizeIs(3998));
}

TEST(Polygons, CornersThatAreNotFiniteMakeAFan) {
  EXPECT_THAT(MeshOf("OFF\n4 1 0\n0 0 0\nnan 0 0\n1 1 0\n0 inf 0\n4 0 1 2 3\n", Format::kOff).triangles, SizeIs(2));
}

// --- OBJ ----------------------------------------------------------------------------------------------------------------

TEST(Obj, TakesEveryKindOfCorner) {
  const std::string vertices = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvn 0 0 1\n";
  for (const char* face :
       {"f 1 2 3", "f 1/1 2/1 3/1", "f 1//1 2//1 3//1", "f 1/1/1 2/1/1 3/1/1", "f -3 -2 -1", "f 1 \\\n 2 \\\r\n3"}) {
    const TriangleMesh mesh = MeshOf(vertices + face + "\n", Format::kObj);
    ASSERT_THAT(mesh.triangles, SizeIs(1)) << face;
    EXPECT_EQ(mesh.triangles[0], (Triangle{VertexId(0), VertexId(1), VertexId(2)})) << face;
    EXPECT_THAT(mesh.dropped_attributes, IsEmpty());
  }
}

TEST(Obj, TakesFacesBeforeTheirVertices) {
  EXPECT_THAT(MeshOf("f 1 2 3\nv 0 0 0\nv 1 0 0\nv 0 1 0\n", Format::kObj).triangles, SizeIs(1));
  EXPECT_THAT(ReadText("v 0 0 0\nf 1 2 9\nv 1 0 0\nv 0 1 0\n", Format::kObj),
              StatusIs(StatusCode::kInvalidArgument, "line 2: a face names vertex 9; the file has 3 vertices"));
}

TEST(Obj, RefusesWhatIsNoFace) {
  const std::string v = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  EXPECT_THAT(ReadText(v + "f 0 1 2\n", Format::kObj),
              StatusIs(StatusCode::kInvalidArgument, "line 4: a face names vertex 0"));
  EXPECT_THAT(ReadText(v + "f -4 1 2\n", Format::kObj),
              StatusIs(StatusCode::kInvalidArgument, "only 3 come before it"));
  EXPECT_THAT(ReadText(v + "f 1 2 3x\n", Format::kObj), StatusIs(StatusCode::kInvalidArgument, "\"3x\""));
  EXPECT_THAT(ReadText(v + "f 1 2 5000000000\n", Format::kObj), StatusIs(StatusCode::kInvalidArgument, "5000000000"));
  EXPECT_THAT(ReadText("<html>\n", Format::kObj), StatusIs(StatusCode::kInvalidArgument, "line 1: \"<html>\""));
  EXPECT_THAT(ReadText("v 1 2\n", Format::kObj), StatusIs(StatusCode::kInvalidArgument, "vertex 1 has 2 numbers"));
}

TEST(Obj, IsAPointSetWithoutFacesAndKeepsItsNormals) {
  const TriangleMesh mesh = MeshOf("v 0 0 0\nvn 0 0 2\nv 1 0 0\nvn 0 3 0\n", Format::kObj);
  EXPECT_TRUE(mesh.IsPointSet());
  ASSERT_THAT(mesh.normals, SizeIs(2));
  EXPECT_EQ(mesh.normals[1], (Vec3{0, 1, 0}));
}

TEST(Obj, CountsLinesOfUnknownKinds) {
  const auto read = ReadText("v 0 0 0\nv 1 0 0\nv 0 1 0\nwibble 7\nf 1 2 3\n", Format::kObj);
  ASSERT_THAT(read, IsOk());
  EXPECT_THAT(read->warnings, Contains(HasSubstr("\"wibble\" in line 4")));
}

TEST(Obj, NeverOpensAMaterialLibrary) {
  const auto read = ReadText("mtllib /etc/passwd\nusemtl a\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", Format::kObj);
  ASSERT_THAT(read, IsOk());
  EXPECT_EQ(read->asset.material_libraries, std::vector<std::string>{"/etc/passwd"});
  EXPECT_EQ(read->asset.group_names, std::vector<std::string>{"a"});
  EXPECT_EQ(read->mesh.attributes.groups, std::vector<uint32_t>{0});
}

// --- XYZ ----------------------------------------------------------------------------------------------------------------

TEST(Xyz, ReadsPointsWithAndWithoutNormals) {
  EXPECT_THAT(MeshOf("# points\n0 0 0\n// more\n1 2 3\n", Format::kXyz).positions, SizeIs(2));
  EXPECT_THAT(MeshOf("0 0 0 0 0 1\n1 2 3 0 1 0", Format::kXyz).normals, SizeIs(2));
}

TEST(Xyz, TakesAColourForAColour) {
  const TriangleMesh mesh = MeshOf("0 0 0 255 0 17\n1 2 3 12 80 200\n", Format::kXyz);
  EXPECT_THAT(mesh.normals, IsEmpty());
  EXPECT_THAT(mesh.dropped_attributes, Contains("color"));
}

TEST(Xyz, HoldsThePromiseOfAPtsFile) {
  EXPECT_THAT(MeshOf("2\n0 0 0\n1 2 3\n", Format::kXyz).positions, SizeIs(2));
  EXPECT_THAT(ReadText("3\n0 0 0\n1 2 3\n", Format::kXyz),
              StatusIs(StatusCode::kInvalidArgument, "promises 3 points, but there are 2"));
}

TEST(Xyz, RefusesRaggedLines) {
  EXPECT_THAT(ReadText("0 0 0\n1 2 3 4 5\n", Format::kXyz),
              StatusIs(StatusCode::kInvalidArgument, "line 2: has 5 numbers"));
  EXPECT_THAT(ReadText("0 0\n", Format::kXyz), StatusIs(StatusCode::kInvalidArgument, "line 1: has 2 numbers"));
  EXPECT_THAT(ReadText("0 0 zero\n", Format::kXyz),
              StatusIs(StatusCode::kInvalidArgument, "line 1: \"zero\" is not a number"));
}

TEST(Xyz, WarnsOfNormalsThatAreNone) {
  const auto some = ReadText("0 0 0 0 0 0\n1 2 3 0 0 1\n", Format::kXyz);
  ASSERT_THAT(some, IsOk());
  EXPECT_EQ(some->mesh.normals[0], Vec3());
  EXPECT_THAT(some->warnings, Contains(HasSubstr("1 of 2 normals")));
  const auto none = ReadText("0 0 0 0 0 0\n1 2 3 nan 0 1\n", Format::kXyz);
  ASSERT_THAT(none, IsOk());
  EXPECT_THAT(none->mesh.normals, IsEmpty());
}

}  // namespace
}  // namespace meshfront
