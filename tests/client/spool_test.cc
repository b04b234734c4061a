// Results on their way to a file: spooled in pieces, written in every format, read back by the readers.
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "client/chunk_decoder.h"
#include "client/chunk_spool.h"
#include "client/output_file.h"
#include "client/spool_writer.h"
#include "core/io/mesh_io.h"
#include "proto/wire/crc32c.h"
#include "tests/support/matchers.h"
#include "tests/support/shapes.h"

namespace meshfront {
namespace {

using testing::IsClosedManifold;
using testing::IsOk;
using testing::StatusIs;

// A folder of its own for each test.
class Spool : public ::testing::Test {
 protected:
  Spool() {
    std::string name = ::testing::TempDir() + "meshfront_spool_XXXXXX";
    folder_ = mkdtemp(name.data());
  }
  ~Spool() override { std::filesystem::remove_all(folder_); }

  std::string PathOf(const std::string& name) const { return folder_ + "/" + name; }
  int FilesInFolder() const {
    return static_cast<int>(
        std::distance(std::filesystem::directory_iterator(folder_), std::filesystem::directory_iterator()));
  }

  ChunkSpool SpoolOf(const TriangleMesh& mesh, size_t piece) const {
    absl::StatusOr<ChunkSpool> spool = ChunkSpool::Create(folder_);
    EXPECT_THAT(spool, IsOk());
    std::vector<SpooledVertex> vertices;
    for (const Vec3& p : mesh.positions) {
      const Vec3 n = Normalized(p);
      vertices.push_back({p, {static_cast<float>(n.x), static_cast<float>(n.y), static_cast<float>(n.z)}});
    }
    const absl::Span<const SpooledVertex> all_vertices = vertices;
    const absl::Span<const Triangle> all_triangles = mesh.triangles;
    for (size_t i = 0; i < all_vertices.size(); i += piece)
      EXPECT_THAT(spool->Append(all_vertices.subspan(i, piece), {}), IsOk());
    for (size_t i = 0; i < all_triangles.size(); i += piece)
      EXPECT_THAT(spool->Append({}, all_triangles.subspan(i, piece)), IsOk());
    EXPECT_THAT(spool->Finish(), IsOk());
    return *std::move(spool);
  }

  void Write(const ChunkSpool& spool, Format format, const std::string& name) const {
    absl::StatusOr<std::unique_ptr<OutputFile>> out = OutputFile::Create(PathOf(name));
    ASSERT_THAT(out, IsOk());
    ASSERT_THAT(WriteSpool(spool, format, (*out)->sink()), IsOk());
    ASSERT_THAT((*out)->Commit(), IsOk());
  }

  std::string folder_;
};

std::string Contents(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

double LargestDifference(const TriangleMesh& a, const TriangleMesh& b) {
  double largest = 0;
  for (size_t i = 0; i < a.positions.size(); ++i) largest = std::max(largest, Distance(a.positions[i], b.positions[i]));
  return largest;
}

// 20,480 triangles: more than a block of anything.
TEST_F(Spool, ReadsBackTheSameMeshInEveryIndexedFormat) {
  const TriangleMesh mesh = testing::Icosphere(5);
  const ChunkSpool spool = SpoolOf(mesh, 777);
  for (const char* name : {"a.off", "a.obj", "a.ply", "a.glb", "a.gltf", "a.off.gz", "a.ply.gz"}) {
    const Format format = FormatOfName(name);
    Write(spool, format, name);
    const absl::StatusOr<ReadResult> read = ReadMeshFile(PathOf(name));
    ASSERT_THAT(read, IsOk()) << name;
    EXPECT_TRUE(read->warnings.empty()) << name << ": " << read->warnings.front();
    EXPECT_EQ(read->mesh.triangles, mesh.triangles) << name;
    ASSERT_EQ(read->mesh.positions.size(), mesh.positions.size()) << name;
    const bool exact = format != Format::kGlb && format != Format::kGltf;
    EXPECT_LE(LargestDifference(read->mesh, mesh), exact ? 0 : 1e-7) << name;
  }
}

TEST_F(Spool, WritesAnStlThatWeldsToTheSameSurface) {
  const TriangleMesh mesh = testing::Icosphere(4);
  Write(SpoolOf(mesh, 100), Format::kStl, "a.stl");
  EXPECT_EQ(Contents(PathOf("a.stl")).size(), 84 + 50 * mesh.triangles.size());
  const absl::StatusOr<ReadResult> read = ReadMeshFile(PathOf("a.stl"));
  ASSERT_THAT(read, IsOk());
  EXPECT_EQ(read->mesh.positions.size(), mesh.positions.size());
  EXPECT_THAT(read->mesh, IsClosedManifold());
}

// Vertices first, then triangles that jump between the two ends: every block of the cache is evicted again and again.
TEST_F(Spool, FindsPositionsFarApart) {
  TriangleMesh mesh = testing::Icosphere(6);
  const ChunkSpool spool = SpoolOf(mesh, 5000);
  SpooledPositions positions(spool);
  const size_t n = mesh.positions.size();
  for (size_t i = 0; i < 2000; ++i) {
    const VertexId v(i % 2 == 0 ? i * 7919 % n : n - 1 - i);
    ASSERT_EQ(*positions.At(v), mesh.PositionAt(v));
  }
}

TEST_F(Spool, WritesTheSameBytesWhateverTheChunksWere) {
  const TriangleMesh mesh = testing::Torus(1, 0.3, 60, 20);
  for (const char* name : {"a.off", "a.obj", "a.ply", "a.stl", "a.glb", "a.gltf"}) {
    Write(SpoolOf(mesh, 1), FormatOfName(name), "one");
    Write(SpoolOf(mesh, 100000), FormatOfName(name), "all");
    EXPECT_EQ(Contents(PathOf("one")), Contents(PathOf("all"))) << name;
  }
}

// A unit sphere at x = 1e7, where float32 has steps of 1.
TEST_F(Spool, KeepsTheShapeOfAGlbFarFromTheOrigin) {
  const TriangleMesh mesh = testing::Moved(testing::Icosphere(3), {1e7, 0, 0});
  Write(SpoolOf(mesh, 50), Format::kGlb, "far.glb");
  const absl::StatusOr<ReadResult> read = ReadMeshFile(PathOf("far.glb"));
  ASSERT_THAT(read, IsOk());
  EXPECT_LT(LargestDifference(read->mesh, mesh), 1e-6);
}

TEST_F(Spool, AnnouncesTheExactBoundsOfAGlb) {
  const TriangleMesh mesh = testing::Icosphere(2, 0.1);
  Write(SpoolOf(mesh, 50), Format::kGlb, "a.glb");
  const std::string bytes = Contents(PathOf("a.glb"));
  uint32_t length;
  std::memcpy(&length, bytes.data() + 12, 4);
  const auto document = nlohmann::json::parse(bytes.substr(20, length));
  const float largest = document["accessors"][0]["max"][0].get<float>();
  float seen = -1;
  for (const Vec3& p : mesh.positions) seen = std::max(seen, static_cast<float>(p.x));
  EXPECT_EQ(largest, seen);
  EXPECT_EQ(document["buffers"][0]["byteLength"].get<size_t>(), bytes.size() - 28 - length);
}

TEST_F(Spool, LeavesNoFileBehind) {
  {
    const ChunkSpool spool = SpoolOf(testing::Icosphere(3), 10);
    EXPECT_EQ(FilesInFolder(), 0);
  }
  EXPECT_EQ(FilesInFolder(), 0);
}

TEST_F(Spool, RefusesToWriteAMeshAsPoints) {
  const ChunkSpool spool = SpoolOf(testing::Icosphere(0), 10);
  EXPECT_THAT(CheckWritable(Format::kXyz), StatusIs(absl::StatusCode::kInvalidArgument, "XYZ"));
}

TEST_F(Spool, AnOutputAppearsOnlyWhenCommitted) {
  const std::string path = PathOf("out.txt");
  ASSERT_THAT(WriteWholeFile(path, "before"), IsOk());
  {
    absl::StatusOr<std::unique_ptr<OutputFile>> out = OutputFile::Create(path);
    ASSERT_THAT(out, IsOk());
    ASSERT_THAT((*out)->sink().Append("after"), IsOk());
    EXPECT_EQ(Contents(path), "before");
  }
  EXPECT_EQ(Contents(path), "before");
  EXPECT_EQ(FilesInFolder(), 1);
  ASSERT_THAT(WriteWholeFile(path, "after"), IsOk());
  EXPECT_EQ(Contents(path), "after");
}

TEST_F(Spool, TellsWhenAnOutputCannotBeCreated) {
  EXPECT_THAT(CheckCanBeCreated(PathOf("no/such/folder/out.ply")),
              StatusIs(absl::StatusCode::kInternal, "can't be written"));
  EXPECT_THAT(CheckCanBeCreated(folder_), StatusIs(absl::StatusCode::kInternal, "can't be written"));
  EXPECT_THAT(CheckCanBeCreated(PathOf("out.ply")), IsOk());
  EXPECT_EQ(FilesInFolder(), 0);
}

TEST_F(Spool, TellsOfAFullDisk) {
  absl::StatusOr<std::unique_ptr<OutputFile>> out = OutputFile::Create("/dev/full");
  ASSERT_THAT(out, IsOk());
  const absl::Status written = (*out)->sink().Append("x");
  EXPECT_THAT(written.ok() ? (*out)->Commit() : written, StatusIs(absl::StatusCode::kInternal, "No space left"));
}

TEST_F(Spool, WritesThroughASymbolicLink) {
  ASSERT_THAT(WriteWholeFile(PathOf("real"), "old"), IsOk());
  std::filesystem::create_symlink(PathOf("real"), PathOf("link"));
  ASSERT_THAT(WriteWholeFile(PathOf("link"), "new"), IsOk());
  EXPECT_TRUE(std::filesystem::is_symlink(PathOf("link")));
  EXPECT_EQ(Contents(PathOf("real")), "new");
}

TEST_F(Spool, MakesTheFileThatALinkLeadsToAndKeepsTheLink) {
  std::filesystem::create_directory(PathOf("folder"));
  std::filesystem::create_symlink("folder/real", PathOf("link"));
  ASSERT_THAT(WriteWholeFile(PathOf("link"), "new"), IsOk());
  EXPECT_TRUE(std::filesystem::is_symlink(PathOf("link")));
  EXPECT_EQ(Contents(PathOf("folder/real")), "new");
  std::filesystem::create_symlink("mesh.off", PathOf("mesh_link.off"));
  ASSERT_THAT(WriteMeshFile(PathOf("mesh_link.off"), testing::Icosphere(0)), IsOk());
  EXPECT_TRUE(std::filesystem::is_symlink(PathOf("mesh_link.off")));
  EXPECT_FALSE(Contents(PathOf("mesh.off")).empty());
}

TEST_F(Spool, TellsOutputsThatAreOneFile) {
  constexpr auto invalid = absl::StatusCode::kInvalidArgument;
  const std::string a = PathOf("a"), b = PathOf("b");
  EXPECT_THAT(CheckNoneCollide({{"OUT", a}, {"--stats", b}, {"--trace", ""}, {"--picture", ""}}), IsOk());
  EXPECT_THAT(CheckNoneCollide({{"OUT", "/dev/null"}, {"--stats", "/dev/null"}}), IsOk());
  EXPECT_THAT(CheckNoneCollide({{"OUT", a}, {"--stats", a}}), StatusIs(invalid, "OUT and --stats are both"));
  EXPECT_THAT(CheckNoneCollide({{"OUT", a}, {"--stats", folder_ + "/./a"}}), StatusIs(invalid, ""));
  EXPECT_THAT(CheckNoneCollide({{"--stats", "-"}, {"--trace", "-"}}), StatusIs(invalid, "standard output"));
  std::filesystem::create_symlink("a", b);
  EXPECT_THAT(CheckNoneCollide({{"OUT", a}, {"--stats", b}}), StatusIs(invalid, ""));
}

// A chunk of one triangle, whole and right.
v1::Chunk OneTriangle() {
  v1::Chunk chunk;
  chunk.set_vertex_count(3);
  chunk.set_triangle_count(1);
  const double positions[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
  const uint32_t indices[3] = {0, 1, 2};
  chunk.set_positions(positions, sizeof(positions));
  chunk.set_indices(indices, sizeof(indices));
  chunk.set_crc32c(ChunkCrc32c(chunk));
  return chunk;
}

TEST(ChunkDecoder, TakesWhatFitsTogether) {
  ChunkDecoder decoder(v1::SCALAR_TYPE_FLOAT64);
  ASSERT_THAT(decoder.Decode(OneTriangle()), IsOk());
  v1::Chunk second = OneTriangle();
  second.set_sequence(1);
  second.set_first_vertex(3);
  ASSERT_THAT(decoder.Decode(second), IsOk());
  EXPECT_EQ(decoder.vertex_count(), 6u);
  EXPECT_EQ(decoder.triangle_count(), 2u);
  EXPECT_EQ(decoder.vertices()[1].position, (Vec3{1, 0, 0}));
}

TEST(ChunkDecoder, RefusesEveryKindOfDamage) {
  const auto expect_refused = [](const char* what, const std::function<void(v1::Chunk&)>& damage,
                                 bool checksum_right = true) {
    v1::Chunk chunk = OneTriangle();
    damage(chunk);
    if (checksum_right) chunk.set_crc32c(ChunkCrc32c(chunk));
    ChunkDecoder decoder(v1::SCALAR_TYPE_FLOAT64);
    EXPECT_THAT(decoder.Decode(chunk), StatusIs(absl::StatusCode::kDataLoss, what));
  };
  expect_refused("its turn was chunk 0", [](v1::Chunk& c) { c.set_sequence(1); });
  expect_refused("it begins at vertex 7", [](v1::Chunk& c) { c.set_first_vertex(7); });
  expect_refused("the size of its positions", [](v1::Chunk& c) { c.set_vertex_count(4); });
  expect_refused("the size of its positions", [](v1::Chunk& c) { c.mutable_positions()->pop_back(); });
  expect_refused("the size of its normals", [](v1::Chunk& c) { c.set_normals("abc"); });
  expect_refused("the size of its indices", [](v1::Chunk& c) { c.set_triangle_count(0x80000000u); });
  expect_refused(
      "checksum", [](v1::Chunk& c) { c.mutable_positions()->at(3) ^= 1; }, false);
  expect_refused("names vertex 3", [](v1::Chunk& c) { c.mutable_indices()->at(0) = 3; });
  expect_refused("not finite", [](v1::Chunk& c) { c.mutable_positions()->replace(6, 2, "\xf0\x7f"); });
}

}  // namespace
}  // namespace meshfront
