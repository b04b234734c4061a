// Files: opening, gzip, limits, and writing that leaves either the old file or the new one.
#include <sys/stat.h>
#include <unistd.h>

#include <fstream>
#include <sstream>

#include "core/io/file_bytes.h"
#include "core/io/gzip.h"
#include "core/io/mesh_io.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/core/io/support.h"
#include "tests/support/matchers.h"
#include "tests/support/shapes.h"

namespace meshfront {
namespace {

using absl::StatusCode;
using testing::IsOk;
using testing::ReadText;
using testing::StatusIs;
using testing::TemporaryFolder;

std::string Contents(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  std::ostringstream out;
  out << in.rdbuf();
  return out.str();
}

std::string Gzipped(const std::string& text) {
  StringSink sink;
  GzipSink gzip(sink);
  EXPECT_THAT(gzip.Append(text), IsOk());
  EXPECT_THAT(gzip.Finish(), IsOk());
  return sink.Take();
}

TEST(Names, GiveTheFormat) {
  EXPECT_EQ(FormatOfName("a/b.c/mesh.PLY"), Format::kPly);
  EXPECT_EQ(FormatOfName("mesh.obj.gz"), Format::kObj);
  EXPECT_EQ(FormatOfName("MESH.STL.GZ"), Format::kStl);
  EXPECT_EQ(FormatOfName("glb"), Format::kGlb);
  EXPECT_EQ(FormatOfName(".gltf"), Format::kGltf);
  EXPECT_EQ(FormatOfName("folder.off/mesh"), Format::kUnknown);
  EXPECT_EQ(FormatOfName("mesh.off.bak"), Format::kUnknown);
  EXPECT_EQ(FormatOfName(""), Format::kUnknown);
}

TEST(Reading, AFileThatIsNotThereIsNotFound) {
  const TemporaryFolder folder;
  EXPECT_THAT(ReadMeshFile(folder.File("missing.off")), StatusIs(StatusCode::kNotFound, "missing.off can't be opened"));
  EXPECT_THAT(ReadMeshFile(folder.path()), StatusIs(StatusCode::kNotFound, "is a folder"));
}

TEST(Reading, StopsAtTheLimitCompressedOrNot) {
  const TemporaryFolder folder;
  const TriangleMesh sphere = testing::Icosphere(2);
  for (const char* name : {"sphere.off", "sphere.off.gz"}) {
    ASSERT_THAT(WriteMeshFile(folder.File(name), sphere), IsOk());
    const uint64_t size = FormatMesh(sphere, Format::kOff)->size();
    EXPECT_THAT(ReadMeshFile(folder.File(name), {.max_decompressed_bytes = size}), IsOk());
    EXPECT_THAT(ReadMeshFile(folder.File(name), {.max_decompressed_bytes = size - 1}),
                StatusIs(StatusCode::kInvalidArgument, "limit"));
  }
}

TEST(Gzip, ReadsMembersOneAfterTheOther) {
  const std::string text = *FormatMesh(testing::Icosphere(1), Format::kOff);
  const std::string halves = Gzipped(text.substr(0, 100)) + Gzipped(text.substr(100)) + std::string(512, '\0');
  EXPECT_THAT(ReadText(halves), IsOk());
  EXPECT_THAT(ReadText(halves + "more"), StatusIs(StatusCode::kInvalidArgument, "not gzip"));
}

TEST(Gzip, RefusesEveryTruncationAndEveryDamagedByte) {
  const std::string whole = Gzipped(*FormatMesh(testing::Cube(1), Format::kOff));
  for (size_t length = 1; length < whole.size(); ++length) {
    EXPECT_THAT(ReadText(whole.substr(0, length), Format::kOff), StatusIs(StatusCode::kInvalidArgument, "test: "))
        << length;
  }
  for (size_t at = 10; at < whole.size(); ++at) {  // the ten bytes before hold a name's flags and a time
    std::string damaged = whole;
    damaged[at] = static_cast<char>(damaged[at] ^ 0x10);
    EXPECT_THAT(ReadText(damaged, Format::kOff), StatusIs(StatusCode::kInvalidArgument, "test: ")) << at;
  }
}

TEST(Gzip, ABombStopsAtTheLimit) {
  const std::string bomb = Gzipped(std::string(64 << 20, ' '));
  EXPECT_LT(bomb.size(), 100000u);
  EXPECT_THAT(ReadMesh(testing::BytesOf(bomb), Format::kOff, "bomb", {.max_decompressed_bytes = 1 << 20}),
              StatusIs(StatusCode::kInvalidArgument, "bomb: decompresses to more than 1048576 bytes"));
}

TEST(Writing, ReplacesAFileAndKeepsItsRights) {
  const TemporaryFolder folder;
  const std::string path = folder.File("mesh.off");
  std::ofstream(path) << "old";
  ASSERT_EQ(::chmod(path.c_str(), 0640), 0);
  ASSERT_THAT(WriteMeshFile(path, testing::OneTriangle()), IsOk());
  EXPECT_EQ(Contents(path), "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
  struct stat facts;
  ASSERT_EQ(::stat(path.c_str(), &facts), 0);
  EXPECT_EQ(facts.st_mode & 07777, 0640u);
  EXPECT_EQ(folder.Entries(), 1u);
}

TEST(Writing, LeavesTheOldFileWhenItFails) {
  const TemporaryFolder folder;
  const std::string path = folder.File("mesh.stl");
  std::ofstream(path) << "old";
  // The second triangle can't be written: by then the first has been.
  TriangleMesh mesh = testing::OneTriangle();
  mesh.positions.push_back({1e300, 0, 0});
  mesh.triangles.push_back({VertexId(0), VertexId(1), VertexId(3)});
  EXPECT_THAT(WriteMeshFile(path, mesh), StatusIs(StatusCode::kInvalidArgument, "32-bit floats"));
  EXPECT_EQ(Contents(path), "old");
  EXPECT_EQ(folder.Entries(), 1u);
}

TEST(Writing, FollowsALinkAndWritesToAPipe) {
  const TemporaryFolder folder;
  std::filesystem::create_symlink("real.off", folder.File("link.off"));
  std::ofstream(folder.File("real.off")) << "old";
  ASSERT_THAT(WriteMeshFile(folder.File("link.off"), testing::OneTriangle()), IsOk());
  EXPECT_TRUE(std::filesystem::is_symlink(folder.File("link.off")));
  EXPECT_THAT(ReadMeshFile(folder.File("real.off")), IsOk());
  EXPECT_THAT(WriteMeshFile("/dev/null", testing::OneTriangle(), Format::kPly), IsOk());
}

TEST(Writing, SaysWhyItCanNot) {
  const TemporaryFolder folder;
  EXPECT_THAT(WriteMeshFile(folder.File("missing/mesh.off"), testing::OneTriangle()),
              StatusIs(StatusCode::kNotFound, "can't be created"));
  EXPECT_THAT(WriteMeshFile(folder.path(), testing::OneTriangle(), Format::kOff),
              StatusIs(StatusCode::kFailedPrecondition, "is a folder"));
  EXPECT_THAT(WriteMeshFile(folder.File("mesh.doc"), testing::OneTriangle()),
              StatusIs(StatusCode::kInvalidArgument, "names no format"));
  EXPECT_EQ(folder.Entries(), 0u);
}

TEST(Writing, AFullDiskIsReported) {
  if (::access("/dev/full", W_OK) != 0) GTEST_SKIP() << "no /dev/full";
  EXPECT_THAT(WriteMeshFile("/dev/full", testing::Icosphere(4), Format::kOff),
              StatusIs(StatusCode::kResourceExhausted, "/dev/full can't be written"));
}

}  // namespace
}  // namespace meshfront
