// What every format promises: one suite over the table.
#include <cmath>

#include "core/io/format_table.h"
#include "core/io/mesh_io.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/core/io/support.h"
#include "tests/support/matchers.h"
#include "tests/support/shapes.h"

namespace meshfront {
namespace {

using testing::BytesOf;
using testing::IsOk;
using testing::StatusIs;

class FormatContract : public ::testing::TestWithParam<Format> {
 protected:
  bool HoldsTriangles() const { return GetParam() != Format::kXyz; }
  bool HoldsPoints() const { return GetParam() != Format::kStl; }
  bool IsExact() const {
    return GetParam() == Format::kOff || GetParam() == Format::kObj || GetParam() == Format::kPly ||
           GetParam() == Format::kXyz;
  }
  bool IsText() const { return GetParam() == Format::kOff || GetParam() == Format::kObj || GetParam() == Format::kXyz; }

  std::string Written(const TriangleMesh& mesh) const {
    const auto bytes = FormatMesh(mesh, GetParam());
    EXPECT_THAT(bytes, IsOk());
    return bytes.ok() ? *bytes : "";
  }
  // A small file of this format.
  std::string Small() const {
    TriangleMesh mesh = testing::Cube(1);
    if (!HoldsTriangles()) mesh.triangles = {};
    return Written(mesh);
  }
};

TriangleMesh WithoutTriangles(TriangleMesh mesh) {
  mesh.triangles = {};
  return mesh;
}

// The same triangles up to the numbering of vertices, corners no farther apart than `tolerance`.
void ExpectSameTriangles(const TriangleMesh& a, const TriangleMesh& b, double tolerance) {
  ASSERT_EQ(a.triangles.size(), b.triangles.size());
  for (size_t i = 0; i < a.triangles.size(); ++i) {
    for (int corner = 0; corner < 3; ++corner) {
      ASSERT_LE(Distance(a.PositionAt(a.triangles[i][corner]), b.PositionAt(b.triangles[i][corner])), tolerance)
          << "triangle " << i;
    }
  }
}

TEST_P(FormatContract, BringsBackTheTrianglesOfATorus) {
  if (!HoldsTriangles()) GTEST_SKIP() << "holds points only";
  const TriangleMesh torus = testing::Torus(1, 0.3, 24, 12);
  const auto read = testing::ReadText(Written(torus), GetParam());
  ASSERT_THAT(read, IsOk());
  EXPECT_EQ(read->format, GetParam());
  EXPECT_TRUE(read->warnings.empty()) << read->warnings[0];
  EXPECT_EQ(read->mesh.positions.size(), torus.positions.size());
  ExpectSameTriangles(read->mesh, torus, IsExact() ? 0 : 1e-6);
  EXPECT_THAT(read->mesh, testing::IsClosedManifold());
}

TEST_P(FormatContract, BringsBackAPointSetWithItsNormals) {
  TriangleMesh points = WithoutTriangles(testing::Icosphere(2));
  points.normals = points.positions;
  if (!HoldsPoints()) {
    EXPECT_THAT(FormatMesh(points, GetParam()), StatusIs(absl::StatusCode::kInvalidArgument, "point set"));
    return;
  }
  const auto read = testing::ReadText(Written(points), GetParam());
  ASSERT_THAT(read, IsOk());
  EXPECT_TRUE(read->mesh.IsPointSet());
  ASSERT_EQ(read->mesh.positions.size(), points.positions.size());
  ASSERT_EQ(read->mesh.normals.size(), points.positions.size());
  EXPECT_THAT(read->mesh.dropped_attributes, ::testing::IsEmpty());
  for (size_t i = 0; i < points.positions.size(); ++i) {
    EXPECT_LE(Distance(read->mesh.positions[i], points.positions[i]), IsExact() ? 0 : 1e-7);
    EXPECT_LE(Distance(read->mesh.normals[i], points.normals[i]), 2e-7);
  }
}

TEST_P(FormatContract, KeepsTheShapeOfASphereFarFromTheOrigin) {
  if (!HoldsTriangles() || GetParam() == Format::kStl) GTEST_SKIP() << "plain 32-bit floats, or no triangles";
  const TriangleMesh sphere = testing::Moved(testing::Icosphere(2), {1e6, -2e6, 3e6});
  const auto read = testing::ReadText(Written(sphere), GetParam());
  ASSERT_THAT(read, IsOk());
  ExpectSameTriangles(read->mesh, sphere, IsExact() ? 0 : 1e-6);
}

TEST_P(FormatContract, WritesTheSameBytesTwice) {
  const std::string bytes = Small();
  EXPECT_EQ(bytes, Small());
  const auto read = testing::ReadText(bytes, GetParam());
  ASSERT_THAT(read, IsOk());
  if (GetParam() == Format::kStl) return;  // welding numbers vertices anew
  EXPECT_EQ(Written(read->mesh), bytes);
}

TEST_P(FormatContract, IsRecognisedByContentUnderEveryOtherName) {
  const std::string bytes = Small();
  for (const FormatRow& row : FormatTable()) {
    if (row.format == GetParam() || FindFormat(GetParam())->is_surely == nullptr) continue;
    const auto read = testing::ReadText(bytes, row.format);
    ASSERT_THAT(read, IsOk()) << row.name;
    EXPECT_EQ(read->format, GetParam());
    ASSERT_EQ(read->warnings.size(), 1u);
    EXPECT_THAT(read->warnings[0], ::testing::HasSubstr("the name says " + std::string(row.name)));
  }
  const auto nameless = testing::ReadText(bytes);
  ASSERT_THAT(nameless, IsOk());
  EXPECT_EQ(nameless->format, GetParam());
}

TEST_P(FormatContract, RefusesEveryTruncation) {
  // A text that loses the end of its last number is another sound text, so only cuts before its last line count there.
  const std::string bytes = Small();
  size_t sound = bytes.size();
  if (IsText()) sound = bytes.rfind('\n', bytes.size() - 2) + 1;
  if (GetParam() == Format::kGltf) sound = bytes.size() - 1;  // the last byte is a line end
  for (size_t length = 0; length < sound; ++length) {
    const auto read = testing::ReadText(bytes.substr(0, length), GetParam());
    // OBJ and XYZ have no counts: a cut between lines leaves fewer of them.
    if (GetParam() == Format::kObj || GetParam() == Format::kXyz) {
      EXPECT_TRUE(read.ok() || read.status().code() == absl::StatusCode::kInvalidArgument) << length << read.status();
    } else {
      EXPECT_THAT(read, StatusIs(absl::StatusCode::kInvalidArgument, "test: ")) << length << " of " << bytes.size();
    }
  }
}

// A generator that is the same everywhere (SplitMix64).
class Dice {
 public:
  explicit Dice(uint64_t seed) : state_(seed) {}
  uint64_t Roll(uint64_t sides) {
    uint64_t z = (state_ += 0x9e3779b97f4a7c15u);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return (z ^ (z >> 31)) % sides;
  }

 private:
  uint64_t state_;
};

std::string Mutated(std::string bytes, Dice& dice) {
  for (uint64_t n = 1 + dice.Roll(4); n > 0 && !bytes.empty(); --n) {
    const size_t at = dice.Roll(bytes.size());
    switch (dice.Roll(6)) {
      case 0:
        bytes[at] = static_cast<char>(bytes[at] ^ (1 << dice.Roll(8)));
        break;
      case 1:
        bytes[at] = static_cast<char>(dice.Roll(256));
        break;
      case 2:
        bytes[at] = "0123456789-+.eE/#\\\"{}[],: \n"[dice.Roll(27)];
        break;
      case 3:
        bytes.erase(at, 1 + dice.Roll(8));
        break;
      case 4:
        bytes.insert(at, bytes.substr(dice.Roll(bytes.size()), dice.Roll(40)));
        break;
      case 5:
        bytes.replace(at, 4, std::string(4, dice.Roll(2) ? '\xff' : '\0'));
        break;
    }
  }
  return bytes;
}

// Whatever the bytes are: a sound mesh or InvalidArgument, never a crash.
void ExpectSoundOrRefused(const std::string& bytes, Format format) {
  const auto read = testing::ReadText(bytes, format);
  if (!read.ok()) {
    EXPECT_THAT(read, StatusIs(absl::StatusCode::kInvalidArgument, "test: "));
    return;
  }
  EXPECT_FALSE(read->mesh.positions.empty());
  for (const Triangle& t : read->mesh.triangles) {
    for (const VertexId v : t) ASSERT_LT(v.index(), read->mesh.positions.size());
  }
  EXPECT_TRUE(read->mesh.normals.empty() || read->mesh.normals.size() == read->mesh.positions.size());
}

TEST_P(FormatContract, ReadsOrRefusesFourThousandMutations) {
  const std::string bytes = Small();
  Dice dice(17 + static_cast<uint64_t>(GetParam()));
  for (int i = 0; i < 4000; ++i) ExpectSoundOrRefused(Mutated(bytes, dice), GetParam());
}

TEST_P(FormatContract, SurvivesEveryFlippedBit) {
  const std::string bytes = Small();
  for (size_t bit = 0; bit < 8 * bytes.size(); ++bit) {
    std::string flipped = bytes;
    flipped[bit / 8] = static_cast<char>(flipped[bit / 8] ^ (1 << bit % 8));
    ExpectSoundOrRefused(flipped, GetParam());
  }
}

TEST_P(FormatContract, ReadsGzipFromAFileAndWritesIt) {
  const testing::TemporaryFolder folder;
  const std::string path = folder.File("mesh." + std::string(FindFormat(GetParam())->endings[0]) + ".gz");
  TriangleMesh mesh = testing::Icosphere(2);
  if (!HoldsTriangles()) mesh.triangles = {};
  ASSERT_THAT(WriteMeshFile(path, mesh), IsOk());
  const auto read = ReadMeshFile(path);
  ASSERT_THAT(read, IsOk());
  EXPECT_EQ(read->format, GetParam());
  EXPECT_EQ(read->mesh.triangles.size(), mesh.triangles.size());
  EXPECT_EQ(folder.Entries(), 1u);
}

TEST_P(FormatContract, RefusesToWriteAnEmptyMeshAndAnIndexOutOfRange) {
  EXPECT_THAT(FormatMesh({}, GetParam()), StatusIs(absl::StatusCode::kInvalidArgument, "no vertices"));
  TriangleMesh broken = testing::OneTriangle();
  broken.triangles[0][1] = VertexId(3);
  EXPECT_THAT(FormatMesh(broken, GetParam()),
              StatusIs(absl::StatusCode::kInvalidArgument, "triangle 0 names vertex 3"));
}

TEST_P(FormatContract, RefusesAnEmptyFile) {
  EXPECT_THAT(testing::ReadText("", GetParam()), StatusIs(absl::StatusCode::kInvalidArgument, "empty"));
  EXPECT_THAT(testing::ReadText(" ", GetParam()), StatusIs(absl::StatusCode::kInvalidArgument, "test: "));
}

INSTANTIATE_TEST_SUITE_P(AllFormats, FormatContract,
                         ::testing::Values(Format::kOff, Format::kObj, Format::kPly, Format::kStl, Format::kGlb,
                                           Format::kGltf, Format::kXyz),
                         [](const auto& info) { return std::string(FormatName(info.param)); });

}  // namespace
}  // namespace meshfront
