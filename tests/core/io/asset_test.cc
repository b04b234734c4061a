// Attributes in files: what is written is read again, and what lies around a glTF's meshes stays.
#include <limits>
#include <nlohmann/json.hpp>

#include "core/io/mesh_io.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/core/io/support.h"
#include "tests/support/matchers.h"
#include "tests/support/shapes.h"
#include "tests/support/textured.h"

namespace meshfront {
namespace {

using ::testing::ElementsAre;
using testing::Glb;
using ::testing::IsEmpty;
using testing::IsOk;
using testing::Raw;
using testing::ReadText;

// A cylinder with a seam, normals, colours and two groups.
TriangleMesh Painted() {
  TriangleMesh mesh = testing::Textured(testing::OpenCylinder(1, 2, 12, 3), testing::AroundZ);
  mesh = testing::WithChannel(mesh, "NORMAL", 3, [](const Vec3& p, const Vec3&) {
    const Vec3 n = (1 + 1e-4 * p.z) * Normalized(Vec3{p.x, p.y, 0});  // of unit length as files have it
    return std::vector<float>{static_cast<float>(n.x), static_cast<float>(n.y), static_cast<float>(n.z)};
  });
  mesh = testing::WithChannel(mesh, "COLOR_0", 4, [](const Vec3& p, const Vec3&) {
    return std::vector<float>{p.x > 0 ? 1.0f : 0.2f, 0, p.y > 0 ? 0.4f : 0.6f, 1};
  });
  for (size_t f = 0; f < mesh.triangles.size(); ++f) mesh.attributes.groups.push_back(f % 5 == 0);
  return mesh;
}

std::string Replaced(std::string text, const std::string& what, const std::string& by) {
  const size_t at = text.find(what);
  EXPECT_NE(at, std::string::npos) << what;
  return at == std::string::npos ? text : text.replace(at, what.size(), by);
}

// By the places of its corners, sorted: the values of each face.
std::vector<std::vector<float>> Faces(const TriangleMesh& mesh) {
  std::vector<std::vector<float>> faces;
  for (size_t f = 0; f < mesh.triangles.size(); ++f) {
    std::vector<float> face = {static_cast<float>(mesh.attributes.GroupOf(f))};
    for (int i = 0; i < 3; ++i) {
      const Vec3& p = mesh.PositionAt(mesh.triangles[f][i]);
      for (int axis = 0; axis < 3; ++axis) face.push_back(static_cast<float>(p[axis]));
      for (const float value : mesh.attributes.WedgeAt(mesh.attributes.corners[f][i])) face.push_back(value);
    }
    faces.push_back(std::move(face));
  }
  std::sort(faces.begin(), faces.end());
  return faces;
}

TriangleMesh ThereAndBack(const TriangleMesh& mesh, Format format, std::vector<std::string>& left_out) {
  const absl::StatusOr<std::string> bytes = FormatAsset(mesh, format, {}, left_out);
  EXPECT_THAT(bytes, IsOk());
  if (!bytes.ok()) return {};
  const absl::StatusOr<ReadResult> read = ReadText(*bytes, format);
  EXPECT_THAT(read, IsOk());
  return read.ok() ? read->mesh : TriangleMesh();
}

TEST(Asset, NamesEachMaterialOfAnObjOnce) {
  std::vector<std::string> left_out;
  const absl::StatusOr<std::string> text = FormatAsset(Painted(), Format::kObj, {}, left_out);
  ASSERT_THAT(text, IsOk());
  std::vector<std::string> names;
  for (size_t at = text->find("usemtl "); at != std::string::npos; at = text->find("usemtl ", at + 1))
    names.push_back(text->substr(at + 7, text->find('\n', at) - at - 7));
  EXPECT_THAT(names, ElementsAre("group_0", "group_1"));
}

TEST(Asset, ComesBackFromGlbAndGltf) {
  for (const Format format : {Format::kGlb, Format::kGltf}) {
    std::vector<std::string> left_out;
    const TriangleMesh mesh = Painted(), back = ThereAndBack(mesh, format, left_out);
    EXPECT_THAT(left_out, IsEmpty());
    EXPECT_EQ(back.attributes.channels, mesh.attributes.channels);
    EXPECT_EQ(Faces(back), Faces(mesh));
  }
}

TEST(Asset, ComesBackFromObjWithoutColours) {
  std::vector<std::string> left_out;
  const TriangleMesh back = ThereAndBack(Painted(), Format::kObj, left_out);
  EXPECT_THAT(left_out, ElementsAre("COLOR_0"));
  EXPECT_THAT(back.attributes.channels, ElementsAre(AttributeChannel{"TEXCOORD_0", 2}, AttributeChannel{"NORMAL", 3}));
  EXPECT_EQ(back.positions.size(), Painted().positions.size());  // seams split no vertex
  EXPECT_EQ(back.attributes.groups.size(), back.triangles.size());
}

TEST(Asset, ComesBackFromPlyWithColoursInBytes) {
  std::vector<std::string> left_out;
  const TriangleMesh mesh = Painted();
  const TriangleMesh back = ThereAndBack(mesh, Format::kPly, left_out);
  EXPECT_EQ(back.positions.size(), mesh.positions.size());  // no vertex is split
  EXPECT_THAT(left_out, ElementsAre("TEXCOORD_0", "materials"));
  ASSERT_EQ(back.triangles.size(), mesh.triangles.size());
  const uint32_t was = *mesh.attributes.OffsetOf("COLOR_0"), is = *back.attributes.OffsetOf("COLOR_0");
  for (size_t f = 0; f < mesh.triangles.size(); ++f) {
    for (int i = 0; i < 3; ++i) {
      for (int c = 0; c < 4; ++c) {
        EXPECT_NEAR(back.attributes.WedgeAt(back.attributes.corners[f][i])[is + c],
                    mesh.attributes.WedgeAt(mesh.attributes.corners[f][i])[was + c], 0.5 / 255 + 1e-6);
      }
    }
  }
}

TEST(Asset, KeepsNumbersOfPlyVerticesByTheirNames) {
  const auto read = ReadText(
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
      "property float quality\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
      "0 0 0 5\n1 0 0 6\n0 1 0 7\n3 0 1 2\n",
      Format::kPly);
  ASSERT_THAT(read, IsOk());
  EXPECT_THAT(read->mesh.attributes.channels, ElementsAre(AttributeChannel{"quality", 1}));
  EXPECT_THAT(read->mesh.attributes.values, ElementsAre(5, 6, 7));
}

// A node that turns and mirrors, with a material, an image in the buffer, a node without mesh, and an animation.
std::string AnimatedGlb() {
  const std::string buffer = Raw({0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f, 0.f}) + Raw({0.f, 0.f, 1.f, 0.f, 0.f, 1.f}) +
                             Raw({0.f, 1.f}) + Raw({0.f, 0.f, 0.f, 1.f, 2.f, 3.f}) + "PNG.";
  return Glb(
      R"({"asset":{"version":"2.0","generator":"hand"},"scene":0,"scenes":[{"nodes":[0]}],)"
      R"("nodes":[{"name":"root","children":[1],"translation":[5,0,0]},{"name":"leaf","mesh":0,"scale":[2,-1,3],"extras":{"a":1}}],)"
      R"("meshes":[{"name":"m","primitives":[{"attributes":{"POSITION":0,"TEXCOORD_0":1},"material":0}]}],)"
      R"("materials":[{"name":"red","pbrMetallicRoughness":{"baseColorTexture":{"index":0}}}],"textures":[{"source":0}],)"
      R"("images":[{"bufferView":4,"mimeType":"image/png"}],)"
      R"("animations":[{"channels":[{"sampler":0,"target":{"node":1,"path":"translation"}}],"samplers":[{"input":2,"output":3}]}],)"
      R"("accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"},)"
      R"({"bufferView":1,"componentType":5126,"count":3,"type":"VEC2"},)"
      R"({"bufferView":2,"componentType":5126,"count":2,"type":"SCALAR","min":[0],"max":[1]},)"
      R"({"bufferView":3,"componentType":5126,"count":2,"type":"VEC3"}],)"
      R"("bufferViews":[{"buffer":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteLength":24},)"
      R"({"buffer":0,"byteOffset":60,"byteLength":8},{"buffer":0,"byteOffset":68,"byteLength":24},)"
      R"({"buffer":0,"byteOffset":92,"byteLength":4}],"buffers":[{"byteLength":96}]})",
      buffer);
}

TEST(Asset, KeepsWhatLiesAroundTheMeshesOfAGltf) {
  const auto read = ReadText(AnimatedGlb(), Format::kGlb);
  ASSERT_THAT(read, IsOk());
  EXPECT_THAT(read->mesh.dropped_attributes, IsEmpty());
  std::vector<std::string> left_out;
  const absl::StatusOr<std::string> text = FormatAsset(read->mesh, Format::kGltf, read->asset, left_out);
  ASSERT_THAT(text, IsOk());
  EXPECT_THAT(left_out, IsEmpty());
  const nlohmann::json doc = nlohmann::json::parse(*text);
  EXPECT_EQ(doc["nodes"][0]["name"], "root");
  EXPECT_EQ(doc["nodes"][1]["extras"]["a"], 1);
  EXPECT_EQ(doc["nodes"][1]["scale"][1], -1);
  EXPECT_EQ(doc["meshes"][0]["name"], "m");
  EXPECT_EQ(doc["meshes"][0]["primitives"][0]["material"], 0);
  EXPECT_EQ(doc["materials"][0]["name"], "red");
  const auto& sampler = doc["animations"][0]["samplers"][0];
  EXPECT_EQ(doc["accessors"][sampler["output"].get<size_t>()]["type"], "VEC3");
  EXPECT_EQ(doc["bufferViews"][doc["images"][0]["bufferView"].get<size_t>()]["byteLength"], 4);
  // In the node's own coordinates, with its own sense: the same as was read.
  const auto again = ReadText(*text, Format::kGltf);
  ASSERT_THAT(again, IsOk());
  EXPECT_EQ(Faces(again->mesh), Faces(read->mesh));
  const auto& position = doc["accessors"][doc["meshes"][0]["primitives"][0]["attributes"]["POSITION"].get<size_t>()];
  EXPECT_EQ(position["min"], (std::vector<double>{0, 0, 0}));
  EXPECT_EQ(position["max"], (std::vector<double>{1, 1, 0}));
}

// Two targets of a square: one moves its first corner, and says so of that alone; the other one moves all and turns the normals. A third
// does nothing. An animation moves their weights.
std::string MorphingGlb() {
  const std::string buffer = Raw({0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f, 0.f, 1.f, 1.f, 0.f}) +    // 0: positions
                             Raw({0.f, 0.f, 1.f, 0.f, 0.f, 1.f, 0.f, 0.f, 1.f, 0.f, 0.f, 1.f}) +    // 48: normals
                             Raw<uint8_t>({0, 1, 2, 2, 1, 3, 0, 0}) + Raw<uint8_t>({0, 0, 0, 0}) +  // 96, 104: a corner
                             Raw({0.f, 0.f, 5.f}) +                                                 // 108: what it adds
                             Raw({.1f, 0.f, 0.f, .2f, 0.f, 0.f, .3f, 0.f, 0.f, .4f, -1.f, 0.f}) +   // 120: to all
                             Raw({0.f, 1.f}) + Raw({0.f, 0.f, 0.f, 1.f, .5f, 0.f});  // 168, 176: times and weights
  return Glb(
      R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0,"scale":[2,-1,3],"weights":[0,1,0]}],)"
      R"("meshes":[{"weights":[0.5,0.25,0],"extras":{"targetNames":["corner","all","none"]},"primitives":[{"indices":6,)"
      R"("attributes":{"POSITION":0,"NORMAL":1},"targets":[{"POSITION":2},{"POSITION":3,"NORMAL":3},{"POSITION":7}]}]}],)"
      R"("animations":[{"channels":[{"sampler":0,"target":{"node":0,"path":"weights"}}],"samplers":[{"input":4,"output":5}]}],)"
      R"("accessors":[{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3","min":[0,0,0],"max":[1,1,0]},)"
      R"({"bufferView":1,"componentType":5126,"count":4,"type":"VEC3"},)"
      R"({"componentType":5126,"count":4,"type":"VEC3","min":[0,0,0],"max":[0,0,5],"sparse":{"count":1,)"
      R"("indices":{"bufferView":3,"componentType":5121},"values":{"bufferView":4}}},)"
      R"({"bufferView":5,"componentType":5126,"count":4,"type":"VEC3","min":[0.1,-1,0],"max":[0.4,0,0]},)"
      R"({"bufferView":6,"componentType":5126,"count":2,"type":"SCALAR","min":[0],"max":[1]},)"
      R"({"bufferView":7,"componentType":5126,"count":6,"type":"SCALAR"},)"
      R"({"bufferView":2,"componentType":5121,"count":6,"type":"SCALAR"},)"
      R"({"componentType":5126,"count":4,"type":"VEC3","min":[0,0,0],"max":[0,0,0]}],)"
      R"("bufferViews":[{"buffer":0,"byteLength":48},{"buffer":0,"byteOffset":48,"byteLength":48},)"
      R"({"buffer":0,"byteOffset":96,"byteLength":6},{"buffer":0,"byteOffset":104,"byteLength":1},)"
      R"({"buffer":0,"byteOffset":108,"byteLength":12},{"buffer":0,"byteOffset":120,"byteLength":48},)"
      R"({"buffer":0,"byteOffset":168,"byteLength":8},{"buffer":0,"byteOffset":176,"byteLength":24}],)"
      R"("buffers":[{"byteLength":200}]})",
      buffer);
}

TEST(Asset, KeepsMorphTargetsTheirWeightsAndWhatMovesThem) {
  const auto read = ReadText(MorphingGlb(), Format::kGlb);
  ASSERT_THAT(read, IsOk());
  EXPECT_THAT(read->mesh.dropped_attributes, IsEmpty());
  EXPECT_THAT(read->mesh.attributes.channels,
              ElementsAre(AttributeChannel{"NORMAL", 3}, AttributeChannel{"MORPH_0_POSITION", 3},
                          AttributeChannel{"MORPH_1_POSITION", 3}, AttributeChannel{"MORPH_1_NORMAL", 3}));
  EXPECT_EQ(read->mesh.attributes.values[5], 5) << "in the node's coordinates";
  std::vector<std::string> left_out;
  const absl::StatusOr<std::string> text = FormatAsset(read->mesh, Format::kGltf, read->asset, left_out);
  ASSERT_THAT(text, IsOk());
  EXPECT_THAT(left_out, IsEmpty());
  const nlohmann::json doc = nlohmann::json::parse(*text);
  const nlohmann::json& mesh = doc["meshes"][0];
  EXPECT_EQ(mesh["extras"]["targetNames"][1], "all");
  EXPECT_EQ(mesh["weights"], (std::vector<double>{0.5, 0.25, 0}));
  EXPECT_EQ(doc["nodes"][0]["weights"], (std::vector<double>{0, 1, 0}));
  ASSERT_EQ(mesh["primitives"][0]["targets"].size(), 3u);
  const nlohmann::json& first = doc["accessors"][mesh["primitives"][0]["targets"][0]["POSITION"].get<size_t>()];
  EXPECT_EQ(first["sparse"]["count"], 1) << "of most corners it says nothing";
  EXPECT_EQ(first["max"], (std::vector<double>{0, 0, 5}));
  const nlohmann::json& none = doc["accessors"][mesh["primitives"][0]["targets"][2]["POSITION"].get<size_t>()];
  EXPECT_EQ(none["min"], none["max"]);
  EXPECT_EQ(doc["animations"][0]["channels"][0]["target"]["path"], "weights");
  const auto again = ReadText(*text, Format::kGltf);
  ASSERT_THAT(again, IsOk());
  EXPECT_THAT(again->mesh.dropped_attributes, IsEmpty());
  // The target that does nothing is written as zeros.
  TriangleMesh same = read->mesh;
  same = testing::WithChannel(same, "MORPH_2_POSITION", 3,
                              [](const Vec3&, const Vec3&) { return std::vector<float>(3, 0); });
  EXPECT_EQ(Faces(again->mesh), Faces(same));
}

// The weights of all levels are moved together.
TEST(Asset, MorphsEveryLevelOfDetail) {
  const auto read = ReadText(MorphingGlb(), Format::kGlb);
  ASSERT_THAT(read, IsOk());
  const std::vector<DetailLevel> levels = {{&read->mesh, 0.5}, {&read->mesh, 0}};
  std::vector<std::string> left_out;
  const absl::StatusOr<std::string> text = FormatLevels(levels, Format::kGltf, read->asset, left_out);
  ASSERT_THAT(text, IsOk());
  EXPECT_THAT(left_out, IsEmpty());
  const nlohmann::json doc = nlohmann::json::parse(*text);
  EXPECT_EQ(doc["nodes"][1]["weights"], (std::vector<double>{0, 1, 0}));
  EXPECT_EQ(doc["meshes"][1]["primitives"][0]["targets"].size(), 3u);
  const nlohmann::json& channels = doc["animations"][0]["channels"];
  ASSERT_EQ(channels.size(), 2u);
  EXPECT_EQ(channels[0]["target"]["node"], 0);
  EXPECT_EQ(channels[1]["target"]["node"], 1);
  EXPECT_EQ(channels[1]["sampler"], channels[0]["sampler"]);
}

// An accessor of another length is none of the primitive's.
TEST(Asset, SaysWhichMorphTargetsAreLost) {
  const std::string glb = Replaced(MorphingGlb(), R"("NORMAL":3)", R"("NORMAL":4)");
  const auto read = ReadText(glb, Format::kGlb);
  ASSERT_THAT(read, IsOk());
  EXPECT_THAT(read->mesh.dropped_attributes, ElementsAre("morph targets"));
  std::vector<std::string> left_out;
  ASSERT_THAT(FormatAsset(read->mesh, Format::kObj, read->asset, left_out), IsOk());
  EXPECT_THAT(left_out, ElementsAre("nodes, textures, animations and skins of the glTF", "morph targets"));
}

// Two for three targets, and one that is no list.
TEST(Asset, DropsWeightsThatAreNotOneForEachTarget) {
  const std::string two = Replaced(MorphingGlb(), R"([0.5,0.25,0])", R"([0.5,0.25]  )");
  const auto read = ReadText(Replaced(two, R"("weights":[0,1,0])", R"("weights":3      )"), Format::kGlb);
  ASSERT_THAT(read, IsOk());
  std::vector<std::string> left_out;
  const absl::StatusOr<std::string> text = FormatAsset(read->mesh, Format::kGltf, read->asset, left_out);
  ASSERT_THAT(text, IsOk());
  const nlohmann::json doc = nlohmann::json::parse(*text);
  EXPECT_FALSE(doc["meshes"][0].contains("weights"));
  EXPECT_FALSE(doc["nodes"][0].contains("weights"));
}

// Whoever has a mesh with morph targets and no file around it gets a glTF that can be moved.
TEST(Asset, WritesMorphTargetsOfAnyMesh) {
  const TriangleMesh mesh = testing::WithChannel(Painted(), "MORPH_1_POSITION", 3, [](const Vec3& p, const Vec3&) {
    return std::vector<float>{0, static_cast<float>(p.z), 0};
  });
  std::vector<std::string> left_out;
  const TriangleMesh back = ThereAndBack(mesh, Format::kGlb, left_out);
  EXPECT_THAT(left_out, IsEmpty());
  ASSERT_EQ(back.attributes.channels.size(), mesh.attributes.channels.size() + 1);  // MORPH_0_POSITION: zeros
  EXPECT_EQ(back.attributes.channels.back(), mesh.attributes.channels.back());
}

// The node with the mesh moves: what moves it must move every level, so the levels hang below it. The other one stands still.
TEST(Asset, HangsLevelsOfDetailOnTheNodesOfAGltf) {
  const auto read = ReadText(AnimatedGlb(), Format::kGlb);
  ASSERT_THAT(read, IsOk());
  TriangleMesh coarse = read->mesh;
  coarse.positions[0] = coarse.positions[0] + 0.25 * (coarse.positions[1] - coarse.positions[0]);
  const std::vector<DetailLevel> levels = {{&read->mesh, 0.5}, {&coarse, 0}};
  std::vector<std::string> left_out;
  const absl::StatusOr<std::string> text = FormatLevels(levels, Format::kGltf, read->asset, left_out);
  ASSERT_THAT(text, IsOk());
  EXPECT_THAT(left_out, IsEmpty());
  const nlohmann::json doc = nlohmann::json::parse(*text);
  EXPECT_EQ(doc["extensionsUsed"], nlohmann::json::array({"MSFT_lod"}));
  const nlohmann::json& moving = doc["nodes"][1];
  EXPECT_FALSE(moving.contains("mesh"));
  ASSERT_EQ(moving["children"].size(), 1u);
  const nlohmann::json& finest = doc["nodes"][moving["children"][0].get<size_t>()];
  EXPECT_EQ(finest["mesh"], 0);
  EXPECT_FALSE(finest.contains("scale"));
  EXPECT_EQ(finest["extras"]["MSFT_screencoverage"], (std::vector<double>{0.5, 0}));
  const nlohmann::json& ids = finest["extensions"]["MSFT_lod"]["ids"];
  ASSERT_EQ(ids.size(), 1u);
  EXPECT_EQ(doc["nodes"][ids[0].get<size_t>()]["mesh"], 1);
  ASSERT_EQ(doc["meshes"].size(), 2u);
  EXPECT_EQ(doc["meshes"][1]["primitives"][0]["material"], 0);
  const auto& position = doc["accessors"][doc["meshes"][1]["primitives"][0]["attributes"]["POSITION"].get<size_t>()];
  EXPECT_NE(position["min"], position["max"]);
  // A reader that does not know the extension finds the finest.
  const auto again = ReadText(*text, Format::kGltf);
  ASSERT_THAT(again, IsOk());
  EXPECT_EQ(Faces(again->mesh), Faces(read->mesh));
}

// Nothing else is said of the node: it keeps its mesh, and its levels stand where it stands.
TEST(Asset, GivesLevelsOfDetailTheTransformOfTheirNode) {
  const std::string json =
      R"({"asset":{"version":"2.0"},"extensionsUsed":["MSFT_lod"],"scene":0,"scenes":[{"nodes":[0]}],)"
      R"("nodes":[{"name":"n","mesh":0,"translation":[1,2,3],"extensions":{"MSFT_lod":{"ids":[1]}}},{"mesh":0}],)"
      R"("meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],)"
      R"("accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}],)"
      R"("bufferViews":[{"buffer":0,"byteLength":36}],"buffers":[{"byteLength":36}]})";
  const auto read = ReadText(Glb(json, Raw({0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f, 0.f})), Format::kGlb);
  ASSERT_THAT(read, IsOk());
  std::vector<std::string> left_out;
  const auto one = FormatAsset(read->mesh, Format::kGltf, read->asset, left_out);
  ASSERT_THAT(one, IsOk());
  EXPECT_FALSE(nlohmann::json::parse(*one).contains("extensionsUsed")) << "the file's own levels are not read";
  EXPECT_THAT(left_out, ::testing::Contains("levels of detail of the glTF"));
  const std::vector<DetailLevel> levels = {{&read->mesh, 0.4}, {&read->mesh, 0.2}, {&read->mesh, 0}};
  const auto text = FormatLevels(levels, Format::kGltf, read->asset, left_out);
  ASSERT_THAT(text, IsOk());
  const nlohmann::json doc = nlohmann::json::parse(*text);
  EXPECT_EQ(doc["nodes"][0]["mesh"], 0);
  EXPECT_EQ(doc["nodes"][0]["extensions"]["MSFT_lod"]["ids"], (std::vector<int>{2, 3}));
  EXPECT_EQ(doc["nodes"][3]["mesh"], 2);
  EXPECT_EQ(doc["nodes"][3]["name"], "n_LOD2");
  EXPECT_EQ(doc["nodes"][3]["translation"], (std::vector<double>{1, 2, 3}));
  EXPECT_EQ(doc["extensionsUsed"], nlohmann::json::array({"MSFT_lod"}));
  EXPECT_FALSE(FormatLevels(levels, Format::kObj, read->asset, left_out).ok());
}

// Their numbers are of accessors that are gone.
TEST(Asset, LeavesOutWhatExtensionsOfMeshesSayOfVertices) {
  const std::string json =
      R"({"asset":{"version":"2.0"},"extensionsUsed":["EXT_mesh_manifold","KHR_materials_variants"],)"
      R"("nodes":[{"mesh":0}],"meshes":[{"extensions":{"EXT_mesh_manifold":{"mergeIndices":2}},)"
      R"("primitives":[{"attributes":{"POSITION":0},"material":7,)"
      R"("extensions":{"KHR_materials_variants":{"mappings":[]}}}]}],)"
      R"("accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}],)"
      R"("bufferViews":[{"buffer":0,"byteLength":36}],"buffers":[{"byteLength":36}]})";
  const auto read = ReadText(Glb(json, Raw({0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f, 0.f})), Format::kGlb);
  ASSERT_THAT(read, IsOk());
  std::vector<std::string> left_out;
  const absl::StatusOr<std::string> text = FormatAsset(read->mesh, Format::kGltf, read->asset, left_out);
  ASSERT_THAT(text, IsOk());
  EXPECT_THAT(left_out, ElementsAre("EXT_mesh_manifold", "material 7, which the glTF does not have"));
  const nlohmann::json doc = nlohmann::json::parse(*text);
  EXPECT_EQ(doc["extensionsUsed"], nlohmann::json::array({"KHR_materials_variants"}));
  EXPECT_FALSE(doc["meshes"][0].contains("extensions"));
  const auto& primitive = doc["meshes"][0]["primitives"][0];
  EXPECT_TRUE(primitive["extensions"].contains("KHR_materials_variants"));
  EXPECT_FALSE(primitive.contains("material"));
}

TEST(Asset, NamesTheFilesBesideIt) {
  const std::string glb = Replaced(AnimatedGlb(), R"("images":[{"bufferView":4,"mimeType":"image/png"}])",
                                   R"("images":[{"uri":"beside.png"},{"uri":"data:,x"} ])");
  const auto read = ReadText(glb, Format::kGlb);
  ASSERT_THAT(read, IsOk());
  EXPECT_THAT(FilesBeside(read->asset), ElementsAre("beside.png"));
}

TEST(Asset, SaysWhichNumbersAreNone) {
  const auto ply = ReadText(
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
      "property float quality\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
      "0 0 0 nan\n1 0 0 6\n0 1 0 inf\n3 0 1 2\n",
      Format::kPly);
  ASSERT_THAT(ply, IsOk());
  EXPECT_THAT(ply->warnings, ElementsAre("2 numbers of attributes are not finite; they are read as 0"));
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const std::string glb =
      Replaced(AnimatedGlb(), Raw({0.f, 0.f, 1.f, 0.f, 0.f, 1.f}), Raw({0.f, nan, 1.f, 0.f, 0.f, 1.f}));
  const auto gltf = ReadText(glb, Format::kGlb);
  ASSERT_THAT(gltf, IsOk());
  EXPECT_THAT(gltf->warnings, ElementsAre("1 numbers of attributes are not finite; they are read as 0"));
}

TEST(Asset, SaysWhatAGltfLosesInOtherFormats) {
  const auto read = ReadText(AnimatedGlb(), Format::kGlb);
  ASSERT_THAT(read, IsOk());
  std::vector<std::string> left_out;
  ASSERT_THAT(FormatAsset(read->mesh, Format::kObj, read->asset, left_out), IsOk());
  EXPECT_THAT(left_out, ElementsAre("nodes, textures, animations and skins of the glTF"));
}

}  // namespace
}  // namespace meshfront
