// PLY and STL: what is peculiar to each.
#include <algorithm>
#include <cmath>

#include "core/io/mesh_io.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/core/io/support.h"
#include "tests/support/matchers.h"
#include "tests/support/shapes.h"

namespace meshfront {
namespace {

using absl::StatusCode;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::IsOk;
using testing::Raw;
using testing::ReadText;
using ::testing::SizeIs;
using testing::StatusIs;

// --- PLY ----------------------------------------------------------------------------------------------------------------

std::string Header(const std::string& format, const std::string& elements) {
  return "ply\nformat " + format + " 1.0\n" + elements + "end_header\n";
}
const char kXyzFloats[] = "property float x\nproperty float y\nproperty float z\n";

std::string Swapped(std::string bytes) {
  std::reverse(bytes.begin(), bytes.end());
  return bytes;
}

TEST(Ply, ReadsBothByteOrders) {
  for (const bool big : {false, true}) {
    auto number = [&](auto value) { return big ? Swapped(Raw({value})) : Raw({value}); };
    std::string bytes =
        Header(big ? "binary_big_endian" : "binary_little_endian",
               "element vertex 3\nproperty double x\nproperty short y\nproperty uchar z\nelement face 1\n"
               "property list ushort int vertex_index\n");
    for (int i = 0; i < 3; ++i)
      bytes += number(0.1 * i) + number(static_cast<int16_t>(-300 * i * i)) + number(static_cast<uint8_t>(200));
    bytes += number(uint16_t{3});
    for (const int32_t i : {2, 1, 0}) bytes += number(i);
    const auto read = ReadText(bytes, Format::kPly);
    ASSERT_THAT(read, IsOk());
    EXPECT_EQ(read->mesh.positions[2], (Vec3{0.1 * 2, -1200, 200}));
    EXPECT_EQ(read->mesh.triangles[0], (Triangle{VertexId(2), VertexId(1), VertexId(0)}));
  }
}

TEST(Ply, PassesOverWhatItDoesNotKnow) {
  const auto read =
      ReadText(Header("ascii",
                      "comment hello\nobj_info x\nelement camera 2\nproperty list uchar float p\nproperty int q\n"
                      "element vertex 3\nproperty float z\nproperty float y\nproperty float x\nproperty uchar red\n"
                      "property float quality\nelement face 1\nproperty list uchar float texcoord\n"
                      "property list uchar uint vertex_indices\n") +
               "2 0.5 0.5 7\n0 8\n3 2 1 9 9\n0 0 1 9 9\n0 1 0 9 9\n6 0 0 1 0 0 1 3 0 1 2\n");
  ASSERT_THAT(read, IsOk());
  EXPECT_EQ(read->mesh.positions[0], (Vec3{1, 2, 3}));
  EXPECT_THAT(read->mesh.triangles, SizeIs(1));
  EXPECT_THAT(read->mesh.dropped_attributes, ::testing::UnorderedElementsAre("element camera", "face texcoord"));
}

TEST(Ply, TurnsStripsIntoTrianglesThatFaceOneWay) {
  // A strip up a ladder, then a second one after -1.
  std::string bytes = Header("binary_little_endian", std::string("element vertex 6\n") + kXyzFloats +
                                                         "element tristrips 1\nproperty list int int vertex_indices\n");
  for (const float y : {0.f, 1.f, 2.f}) bytes += Raw({0.f, y, 0.f, 1.f, y, 0.f});
  bytes += Raw({10, 0, 1, 2, 3, 4, 5, -1, 0, 1, 2});
  const auto read = ReadText(bytes);
  ASSERT_THAT(read, IsOk());
  ASSERT_THAT(read->mesh.triangles, SizeIs(5));
  for (const Triangle& t : read->mesh.triangles) {
    const Vec3 a = read->mesh.PositionAt(t[0]);
    EXPECT_GT(Cross(read->mesh.PositionAt(t[1]) - a, read->mesh.PositionAt(t[2]) - a).z, 0);
  }
}

TEST(Ply, SaysWhichByteOrLineIsWrong) {
  const std::string head =
      Header("binary_little_endian", std::string("element vertex 3\n") + kXyzFloats +
                                         "element face 1\nproperty list uchar int vertex_indices\n");
  const std::string vertices(36, '\0');
  EXPECT_THAT(ReadText(head + vertices + '\3' + Raw({0, 1, 3})),
              StatusIs(StatusCode::kInvalidArgument, "face 0 names vertex 3; there are 3"));
  EXPECT_THAT(ReadText(head + vertices + '\3' + Raw({0, 1, -1})),
              StatusIs(StatusCode::kInvalidArgument, "names vertex -1"));
  EXPECT_THAT(ReadText(head + vertices + '\xff' + Raw({0, 1})),
              StatusIs(StatusCode::kInvalidArgument, "a list of 255 values"));
  EXPECT_THAT(ReadText(Header("ascii", std::string("element vertex 1\n") + kXyzFloats) + "0 zero 0\n"),
              StatusIs(StatusCode::kInvalidArgument, "line 8: \"zero\" is not a number in vertex 0"));
}

TEST(Ply, NeverTrustsACount) {
  EXPECT_THAT(ReadText(Header("ascii", std::string("element vertex 99999999999\n") + kXyzFloats) + "0 0 0\n"),
              StatusIs(StatusCode::kInvalidArgument, "line 3: the header says 99999999999"));
  EXPECT_THAT(ReadText(Header("ascii", std::string("element vertex 1\n") + kXyzFloats +
                                           "element face 1\nproperty list char int vertex_indices\n") +
                       "0 0 0\n-3 0 0 0\n"),
              StatusIs(StatusCode::kInvalidArgument, "a list of -3 values"));
  EXPECT_THAT(ReadText(Header("ascii", "element vertex -1\nproperty float x\n")),
              StatusIs(StatusCode::kInvalidArgument, "negative"));
  // An element without properties takes no bytes and no time.
  EXPECT_THAT(
      ReadText(Header("ascii", std::string("element nothing 9000000000000000000\nelement vertex 1\n") + kXyzFloats) +
               "0 0 0\n"),
      IsOk());
}

TEST(Ply, RefusesAHeaderThatIsNone) {
  EXPECT_THAT(ReadText("ply\nelement vertex 1\n"), StatusIs(StatusCode::kInvalidArgument, "inside the header"));
  EXPECT_THAT(ReadText("ply\nformat ascii 2.0\n"), StatusIs(StatusCode::kInvalidArgument, "version is \"2.0\""));
  EXPECT_THAT(ReadText(Header("ascii", "element vertex 1\nproperty quad x\n")),
              StatusIs(StatusCode::kInvalidArgument, "\"quad\" is no type"));
  EXPECT_THAT(ReadText(Header("ascii", "element vertex 1\nproperty float x\n") + "0\n"),
              StatusIs(StatusCode::kInvalidArgument, "lacks x, y or z"));
  EXPECT_THAT(ReadText(Header("ascii", "element vertex 1\nelement vertex 1\n")),
              StatusIs(StatusCode::kInvalidArgument, "defined twice"));
}

// --- STL ----------------------------------------------------------------------------------------------------------------

const char kFacet[] = "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n";

TEST(Stl, ReadsAsciiWithSeveralSolidsInAnyCase) {
  std::string text = std::string("solid a\n") + kFacet + "endsolid\nsolid b\n" + kFacet + "endsolid b\n";
  const auto lower = ReadText(text);
  ASSERT_THAT(lower, IsOk());
  EXPECT_THAT(lower->mesh.triangles, SizeIs(2));
  EXPECT_THAT(lower->mesh.positions, SizeIs(3));
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::toupper(c); });
  EXPECT_THAT(ReadText(text), IsOk());
}

TEST(Stl, RefusesAsciiThatIsOutOfOrder) {
  EXPECT_THAT(ReadText(std::string("solid a\n") + kFacet), StatusIs(StatusCode::kInvalidArgument, "without endsolid"));
  EXPECT_THAT(ReadText("solid a\nfacet normal 0 0 1\nvertex 0 0 0\nendfacet\n"),
              StatusIs(StatusCode::kInvalidArgument, "line 4: a facet ends after 1 vertices"));
  EXPECT_THAT(ReadText("solid a\nfacet normal 0 0 1\nvertex 0 here 0\n"),
              StatusIs(StatusCode::kInvalidArgument, "line 3: a vertex has \"here\""));
  EXPECT_THAT(ReadText("solid a\nfacet\nbanana\n"), StatusIs(StatusCode::kInvalidArgument, "\"banana\" is no word"));
}

std::string Binary(uint32_t promised, int present, const std::string& name = "") {
  std::string bytes = name;
  bytes.resize(80, ' ');
  bytes += Raw({promised});
  for (int i = 0; i < present; ++i)
    bytes += Raw({0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f, 0.f, float(i), 0.f, 1.f, float(i)}) + std::string(2, '\0');
  return bytes;
}

TEST(Stl, KnowsBinaryByItsSizeWhateverItsHeaderSays) {
  const auto read = ReadText(Binary(4, 4, "solid from some program"));
  ASSERT_THAT(read, IsOk());
  EXPECT_EQ(read->format, Format::kStl);
  EXPECT_THAT(read->mesh.triangles, SizeIs(4));
}

TEST(Stl, ReadsMoreTrianglesThanPromisedButNotFewer) {
  const auto more = ReadText(Binary(2, 5), Format::kStl);
  ASSERT_THAT(more, IsOk());
  EXPECT_THAT(more->mesh.triangles, SizeIs(5));
  EXPECT_THAT(more->warnings, Contains(HasSubstr("the header says 2 triangles, the file has 5")));
  EXPECT_THAT(ReadText(Binary(6, 5), Format::kStl),
              StatusIs(StatusCode::kInvalidArgument, "byte 80: the header says 6 triangles"));
}

TEST(Stl, WeldsZeroWithMinusZeroAndNothingElse) {
  std::string bytes = std::string(80, ' ') + Raw({uint32_t{2}});
  const float tiny = std::nextafter(1.f, 2.f);
  bytes += Raw({0.f, 0.f, 0.f, 0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f, 0.f}) + std::string(2, '\0');
  bytes += Raw({0.f, 0.f, 0.f, -0.f, 0.f, -0.f, 0.f, 1.f, 0.f, tiny, 0.f, 0.f}) + std::string(2, '\0');
  const auto read = ReadText(bytes);
  ASSERT_THAT(read, IsOk());
  EXPECT_THAT(read->mesh.positions, SizeIs(4));
  EXPECT_EQ(read->mesh.triangles[0][0], read->mesh.triangles[1][0]);
}

TEST(Stl, WritesNormalsOfLengthOneAndRefusesWhatAFloatCannotHold) {
  const auto bytes = FormatMesh(testing::Scaled(testing::OneTriangle(), 1e-3), Format::kStl);
  ASSERT_THAT(bytes, IsOk());
  float normal[3];
  std::memcpy(normal, bytes->data() + 84, 12);
  EXPECT_EQ(normal[2], 1.f);
  EXPECT_THAT(FormatMesh(testing::Scaled(testing::OneTriangle(), 1e300), Format::kStl),
              StatusIs(StatusCode::kInvalidArgument, "32-bit floats"));
}

}  // namespace
}  // namespace meshfront
