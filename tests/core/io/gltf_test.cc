// glTF: scenes, accessors, and what must not be opened. What we write is read by tinygltf as well, an independent reader.
#include <cmath>
#include <cstring>
#include <fstream>

#define TINYGLTF_NO_INCLUDE_STB_IMAGE
#define TINYGLTF_NO_INCLUDE_STB_IMAGE_WRITE
#include <tiny_gltf.h>

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
using testing::Glb;
using testing::IsOk;
using testing::Raw;
using testing::ReadText;
using ::testing::SizeIs;
using testing::StatusIs;

// A square 0 0, 1 0, 0 1, 1 1 at z = 0 as floats, then six indices of 16 bits: 48 + 12 bytes.
std::string Square() {
  return Raw({0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f, 0.f, 1.f, 1.f, 0.f}) + Raw<uint16_t>({0, 1, 2, 2, 1, 3});
}
const char kSquareParts[] =
    R"("asset":{"version":"2.0"},"buffers":[{"byteLength":60}],)"
    R"("bufferViews":[{"buffer":0,"byteLength":48},{"buffer":0,"byteOffset":48,"byteLength":12}],)"
    R"("accessors":[{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3"},)"
    R"({"bufferView":1,"componentType":5123,"count":6,"type":"SCALAR"}])";
const char kSquareMesh[] = R"("meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}])";

std::string Scene(const std::string& rest) { return Glb("{" + std::string(kSquareParts) + "," + rest + "}", Square()); }
std::string Nodes(const std::string& nodes, const std::string& roots = "0") {
  return Scene(std::string(kSquareMesh) + R"(,"scenes":[{"nodes":[)" + roots + R"(]}],"nodes":[)" + nodes + "]");
}

double SumOfZ(const TriangleMesh& mesh) {
  double sum = 0;
  for (const Triangle& t : mesh.triangles) {
    sum += Cross(mesh.PositionAt(t[1]) - mesh.PositionAt(t[0]), mesh.PositionAt(t[2]) - mesh.PositionAt(t[0])).z;
  }
  return sum / 2;  // the signed area seen from above
}

TEST(Gltf, AppliesTransformsFromTheRootDown) {
  const auto read = ReadText(Nodes(
      R"({"children":[1],"translation":[10,0,0]},{"mesh":0,"scale":[2,2,2],"rotation":[0,0,0.7071067811865476,0.7071067811865476]})"));
  ASSERT_THAT(read, IsOk());
  // (1, 0, 0) is scaled, turned a quarter to the left, moved.
  EXPECT_LE(Distance(read->mesh.positions[1], {10, 2, 0}), 1e-12);
}

TEST(Gltf, ReadsMatricesColumnByColumn) {
  const auto read = ReadText(Nodes(R"({"mesh":0,"matrix":[0,1,0,0,-1,0,0,0,0,0,1,0,5,6,7,1]})"));
  ASSERT_THAT(read, IsOk());
  EXPECT_EQ(read->mesh.positions[1], (Vec3{5, 7, 7}));
}

TEST(Gltf, AMeshNamedByTwoNodesIsThereTwice) {
  const auto read = ReadText(Nodes(R"({"mesh":0},{"mesh":0,"translation":[0,0,5]})", "0,1"));
  ASSERT_THAT(read, IsOk());
  EXPECT_THAT(read->mesh.positions, SizeIs(8));
  EXPECT_THAT(read->mesh.triangles, SizeIs(4));
  EXPECT_THAT(ReadText(Nodes(R"({"mesh":0})", "0,0"))->mesh.triangles, SizeIs(4));
}

TEST(Gltf, AMirrorTurnsTrianglesOver) {
  EXPECT_NEAR(SumOfZ(ReadText(Nodes(R"({"mesh":0})"))->mesh), 1, 1e-12);
  EXPECT_NEAR(SumOfZ(ReadText(Nodes(R"({"mesh":0,"scale":[1,1,-1]})"))->mesh), -1, 1e-12);
  // Mirrored along x, the square lies elsewhere and still faces up.
  EXPECT_NEAR(SumOfZ(ReadText(Nodes(R"({"mesh":0,"scale":[-1,1,1]})"))->mesh), 1, 1e-12);
}

TEST(Gltf, TakesTheNamedSceneTheFirstOneOrAllThereIs) {
  const std::string mesh =
      std::string(kSquareMesh) + R"(,"nodes":[{"mesh":0},{"mesh":0,"translation":[9,0,0]},{"children":[0,1]}])";
  EXPECT_THAT(ReadText(Scene(mesh + R"(,"scene":1,"scenes":[{"nodes":[0]},{"nodes":[2]}])"))->mesh.triangles,
              SizeIs(4));
  EXPECT_THAT(ReadText(Scene(mesh + R"(,"scenes":[{"nodes":[0]},{"nodes":[2]}])"))->mesh.triangles, SizeIs(2));
  EXPECT_THAT(ReadText(Scene(mesh))->mesh.triangles, SizeIs(4));
  EXPECT_THAT(ReadText(Scene(kSquareMesh))->mesh.triangles, SizeIs(2));
}

TEST(Gltf, ReadsStripsAndFansThatFaceOneWay) {
  const std::string fan = Scene(
      R"("meshes":[{"primitives":[{"attributes":{"POSITION":0},"mode":6},{"attributes":{"POSITION":0},"mode":5}]}])");
  const auto read = ReadText(fan);
  ASSERT_THAT(read, IsOk());
  ASSERT_THAT(read->mesh.triangles, SizeIs(4));
  EXPECT_THAT(read->mesh.positions, SizeIs(4)) << "primitives with the same positions share vertices";
  TriangleMesh strip = read->mesh;
  strip.triangles.erase(strip.triangles.begin(), strip.triangles.begin() + 2);
  EXPECT_NEAR(SumOfZ(strip), 1, 1e-12);
}

TEST(Gltf, PointsAreReadWhereThereIsNothingElse) {
  const auto points =
      ReadText(Scene(R"("meshes":[{"primitives":[{"attributes":{"POSITION":0,"NORMAL":0},"mode":0}]}])"));
  ASSERT_THAT(points, IsOk());
  EXPECT_TRUE(points->mesh.IsPointSet());
  EXPECT_THAT(points->mesh.normals, SizeIs(4));
  const auto both = ReadText(Scene(
      R"("meshes":[{"primitives":[{"attributes":{"POSITION":0},"mode":1},{"attributes":{"POSITION":0},"indices":1}]}])"));
  ASSERT_THAT(both, IsOk());
  EXPECT_THAT(both->mesh.triangles, SizeIs(2));
}

TEST(Gltf, ReadsQuantisedAndSparsePositions) {
  const std::string data = Raw<int16_t>({0, 0, 0, 0, 32767, 0, 0, 0, 0, -32768, 0, 0}) + Raw<uint8_t>({1, 0, 0, 0}) +
                           Raw<int16_t>({0, 0, 32767, 0});
  const std::string json =
      R"({"asset":{"version":"2.0"},"extensionsRequired":["KHR_mesh_quantization"],"buffers":[{"byteLength":36}],)"
      R"("bufferViews":[{"buffer":0,"byteLength":24,"byteStride":8},{"buffer":0,"byteOffset":24,"byteLength":4},{"buffer":0,"byteOffset":28,"byteLength":8}],)"
      R"("accessors":[{"bufferView":0,"componentType":5122,"normalized":true,"count":3,"type":"VEC3","sparse":{"count":1,)"
      R"("indices":{"bufferView":1,"componentType":5121},"values":{"bufferView":2}}}],)"
      R"("meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}]})";
  const auto read = ReadText(Glb(json, data));
  ASSERT_THAT(read, IsOk());
  EXPECT_EQ(read->mesh.positions[0], (Vec3{0, 0, 0}));
  EXPECT_EQ(read->mesh.positions[1], (Vec3{0, 0, 1})) << "replaced";
  EXPECT_EQ(read->mesh.positions[2], (Vec3{0, -1, 0}));
}

TEST(Gltf, NamesWhatItLeavesBehind) {
  const auto read = ReadText(Scene(
      R"("materials":[{}],"meshes":[{"primitives":[{"attributes":{"POSITION":0,"TEXCOORD_0":0,"NORMAL":0},"indices":1,"material":0,"targets":[{}]}]}])"));
  ASSERT_THAT(read, IsOk());
  EXPECT_THAT(read->mesh.dropped_attributes,
              ::testing::ElementsAre("texcoord_0"));  // of three numbers, two are wanted
}

TEST(Gltf, RefusesNodesThatFormACycleOrExplode) {
  EXPECT_THAT(ReadText(Nodes(R"({"children":[1]},{"children":[0]})")),
              StatusIs(StatusCode::kInvalidArgument, "a cycle"));
  EXPECT_THAT(ReadText(Scene(std::string(kSquareMesh) + R"(,"nodes":[{"children":[1]},{"children":[0]}])")),
              StatusIs(StatusCode::kInvalidArgument, "cycle"));
  // Thirty levels, each of which names the next one twice: 2³⁰ copies.
  std::string nodes;
  for (int i = 0; i < 30; ++i) nodes += "{\"children\":[" + std::to_string(i + 1) + "," + std::to_string(i + 1) + "]},";
  EXPECT_THAT(ReadText(Nodes(nodes + R"({"mesh":0})")), StatusIs(StatusCode::kInvalidArgument, "explode"));
}

TEST(Gltf, ReadsAChainOfNodesOfAnyDepth) {
  std::string nodes;
  for (int i = 0; i < 100000; ++i) nodes += "{\"children\":[" + std::to_string(i + 1) + "]},";
  EXPECT_THAT(ReadText(Nodes(nodes + R"({"mesh":0})")), IsOk());
}

TEST(Gltf, RefusesCopiesThatMakeASmallFileHuge) {
  // A mesh of 2 MB, named by 1000 nodes.
  const std::string data(2 << 20, '\0');
  const std::string count = std::to_string(data.size() / 12 / 3 * 3);
  std::string json =
      R"({"asset":{"version":"2.0"},"buffers":[{"byteLength":)" + std::to_string(data.size()) +
      R"(}],"bufferViews":[{"buffer":0,"byteLength":)" + std::to_string(data.size()) +
      R"(}],"accessors":[{"bufferView":0,"componentType":5126,"count":)" + count +
      R"(,"type":"VEC3"}],"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],"nodes":[{"mesh":0})";
  for (int i = 0; i < 1000; ++i) json += R"(,{"mesh":0})";
  EXPECT_THAT(ReadText(Glb(json + "]}", data)), StatusIs(StatusCode::kInvalidArgument, "more than 16 times the file"));
}

TEST(Gltf, RefusesSizesThatDoNotFit) {
  struct Case {
    const char *from, *to, *message;
  };
  for (const Case& c : {Case{R"("byteLength":60)", R"("byteLength":61)", "61"},
                        {R"("byteLength":48)", R"("byteLength":1e300)", "byteLength"},
                        {R"("byteOffset":48)", R"("byteOffset":9007199254740991)", "do not lie in buffers[0]"},
                        {R"("count":4)", R"("count":5)", "5 elements of 12 bytes"},
                        {R"("count":6)", R"("count":5)", ""},
                        {R"("count":6)", R"("count":9007199254740992)", "do not fit"},
                        {R"("count":6)", R"("count":-6)", "at least 1"},
                        {R"("count":6)", R"("count":4)", "multiple of 3"},
                        {R"("bufferView":1)", R"("bufferView":2)", "there are 2"},
                        {R"("buffer":0,"byteOffset")", R"("buffer":1,"byteOffset")", "there are 1"},
                        {"5123", "5122", "unsigned integers"},
                        {"5126", "9999", "no type"},
                        {"VEC3", "VEC9", "SCALAR to VEC4"},
                        {"VEC3", "VEC2", "it must have 3"},
                        {"2.0", "1.0", "asset.version"}}) {
    std::string json = "{" + std::string(kSquareParts) + "," + kSquareMesh + "}";
    json.replace(json.find(c.from), std::strlen(c.from), c.to);
    EXPECT_THAT(ReadText(Glb(json, Square())), StatusIs(StatusCode::kInvalidArgument, c.message)) << c.to;
  }
  std::string bytes = Square();
  bytes[48] = 4;
  EXPECT_THAT(ReadText(Glb("{" + std::string(kSquareParts) + "," + kSquareMesh + "}", bytes)),
              StatusIs(StatusCode::kInvalidArgument,
                       "meshes[0].primitives[0].indices: element 0 is 4, but there are 4 positions"));
}

TEST(Gltf, RefusesJsonThatIsNoneOrTooDeep) {
  for (const char* json : {"{", "}", "", "[1,]", "{\"a\" 1}", "{\"a\":1,}", "{\"a\":01x}", "\"\\u12g4\"", "\"\\q\"",
                           "nul", "{} {}", "{\"asset\":}", "[", "\"", "-", "{1:2}"}) {
    EXPECT_THAT(ReadText(Glb(json)), StatusIs(StatusCode::kInvalidArgument, "")) << json;
  }
  EXPECT_THAT(ReadText(Glb(std::string(100000, '['))),
              StatusIs(StatusCode::kInvalidArgument, "nested more than 128 deep"));
  EXPECT_THAT(ReadText("{\"a\":" + std::string(100000, '['), Format::kGltf),
              StatusIs(StatusCode::kInvalidArgument, "nested"));
}

TEST(Gltf, RefusesAnExtensionThatHoldsTheGeometry) {
  EXPECT_THAT(ReadText(Scene(std::string(kSquareMesh) + R"(,"extensionsRequired":["KHR_draco_mesh_compression"])")),
              StatusIs(StatusCode::kInvalidArgument, "requires the extension \"KHR_draco_mesh_compres"));
  EXPECT_THAT(ReadText(Scene(std::string(kSquareMesh) + R"(,"extensionsRequired":["KHR_materials_unlit"])")), IsOk());
}

// --- Buffers in other files -------------------------------------------------------------------------------------------------

class GltfBuffers : public ::testing::Test {
 protected:
  absl::StatusOr<ReadResult> ReadWith(const std::string& uri) {
    std::string json = "{" + std::string(kSquareParts) + "," + kSquareMesh + "}";
    json.replace(json.find("\"byteLength\":60"), 15, "\"byteLength\":60,\"uri\":\"" + uri + "\"");
    std::filesystem::create_directories(folder_.path() + "/in");
    std::ofstream(folder_.File("in/square.gltf")) << json;
    for (const char* name : {"in/a b.bin", "outside.bin"})
      std::ofstream(folder_.File(name), std::ios::binary) << Square();
    return ReadMeshFile(folder_.File("in/square.gltf"));
  }
  testing::TemporaryFolder folder_;
};

TEST_F(GltfBuffers, AreReadFromTheFolderOfTheFile) {
  EXPECT_THAT(ReadWith("a%20b.bin"), IsOk());
  EXPECT_THAT(ReadWith("./a b.bin"), IsOk());
}

TEST_F(GltfBuffers, AreNeverReadFromElsewhere) {
  for (const std::string uri : {"../outside.bin", "%2e%2e/outside.bin", "/etc/passwd", "file:///etc/passwd",
                                "http://localhost/a", "..\\\\outside.bin", "", "a%00", "a%2"}) {
    EXPECT_THAT(ReadWith(uri), StatusIs(StatusCode::kInvalidArgument, "only files inside the folder")) << uri;
  }
  ASSERT_THAT(ReadWith("missing.bin"), StatusIs(StatusCode::kInvalidArgument, "no such file"));
  std::filesystem::create_symlink("../outside.bin", folder_.File("in/link.bin"));
  EXPECT_THAT(ReadWith("link.bin"), StatusIs(StatusCode::kInvalidArgument, "leaves the folder"));
}

TEST_F(GltfBuffers, AreNotReadForBytesInMemory) {
  EXPECT_THAT(
      ReadText(
          R"({"asset":{"version":"2.0"},"buffers":[{"byteLength":36,"uri":"a.bin"}],"bufferViews":[{"buffer":0,"byteLength":36}],)"
          R"("accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}],"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}]})"),
      StatusIs(StatusCode::kInvalidArgument, "no other file may be opened"));
}

// --- Writing ------------------------------------------------------------------------------------------------------------

TEST(GltfWriting, IsReadByAnotherReader) {
  TriangleMesh mesh = testing::Torus(1, 0.3, 30, 12);
  for (const Vec3& p : mesh.positions) mesh.normals.push_back(Normalized(p - Normalized(Vec3{p.x, p.y, 0})));
  mesh = testing::Moved(mesh, {1000, 0, 0});
  for (const Format format : {Format::kGlb, Format::kGltf}) {
    const auto bytes = FormatMesh(mesh, format);
    ASSERT_THAT(bytes, IsOk());
    tinygltf::TinyGLTF loader;
    tinygltf::Model model;
    std::string error, warning;
    const auto* data = reinterpret_cast<const unsigned char*>(bytes->data());
    const bool loaded = format == Format::kGlb
                            ? loader.LoadBinaryFromMemory(&model, &error, &warning, data, bytes->size())
                            : loader.LoadASCIIFromString(&model, &error, &warning, bytes->data(), bytes->size(), "");
    ASSERT_TRUE(loaded) << error;
    EXPECT_EQ(error + warning, "");
    ASSERT_EQ(model.accessors.size(), 3u);
    EXPECT_EQ(model.accessors[2].count, 3 * mesh.triangles.size());
    EXPECT_EQ(model.nodes[0].translation, (std::vector<double>{1000, 0, 0}));
    // min and max are those of the numbers in the buffer, to the bit.
    float lowest = 1e30f, highest = -1e30f;
    for (size_t i = 0; i < model.accessors[0].count; ++i) {
      float x, normal[3];
      std::memcpy(&x, &model.buffers[0].data[12 * i], 4);
      std::memcpy(normal, &model.buffers[0].data[12 * model.accessors[0].count + 12 * i], 12);
      lowest = std::min(lowest, x), highest = std::max(highest, x);
      EXPECT_NEAR(std::hypot(normal[0], normal[1], normal[2]), 1, 1e-6);
    }
    EXPECT_EQ(model.accessors[0].minValues[0], lowest);
    EXPECT_EQ(model.accessors[0].maxValues[0], highest);
  }
}

TEST(GltfWriting, PadsChunksToFourBytes) {
  for (const Vec3& shift : {Vec3{0, 0, 0}, Vec3{1e4, 0, 0}, Vec3{12345, 0, 0}, Vec3{123456.5, 1, 2}}) {
    const auto bytes = FormatMesh(testing::Moved(testing::OneTriangle(), shift), Format::kGlb);
    ASSERT_THAT(bytes, IsOk());
    uint32_t total, json;
    std::memcpy(&total, bytes->data() + 8, 4), std::memcpy(&json, bytes->data() + 12, 4);
    EXPECT_EQ(total, bytes->size());
    EXPECT_EQ(json % 4, 0u);
    EXPECT_EQ(total % 4, 0u);
  }
}

TEST(GltfWriting, RefusesWhatIsNotFinite) {
  TriangleMesh mesh = testing::OneTriangle();
  mesh.positions[1].y = std::nan("");
  EXPECT_THAT(FormatMesh(mesh, Format::kGlb),
              StatusIs(StatusCode::kInvalidArgument, "vertex 1 has a coordinate that is not finite"));
  EXPECT_THAT(FormatMesh(testing::Scaled(testing::OneTriangle(), 1e200), Format::kGltf),
              StatusIs(StatusCode::kInvalidArgument, "beyond"));
}

}  // namespace
}  // namespace meshfront
