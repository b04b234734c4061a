// The program from a file to a file, the service inside the process.
#include <signal.h>
#include <sys/wait.h>

#include <png.h>
#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <thread>

#include "core/io/mesh_io.h"
#include "gmock/gmock.h"
#include "tests/client/program.h"
#include "tests/support/matchers.h"
#include "tests/support/shapes.h"
#include "tests/support/textured.h"

namespace meshfront::testing {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using Json = nlohmann::json;

bool HasEnded(int pid) {
  siginfo_t info{};
  waitid(P_PID, pid, &info, WEXITED | WNOHANG | WNOWAIT);
  return info.si_pid == pid;
}

class Remesh : public ProgramTest {
 protected:
  Remesh() { EXPECT_THAT(WriteMeshFile(PathOf("in.ply"), Torus(1, 0.4, 80, 40)), IsOk()); }

  TriangleMesh Read(const std::string& name) const {
    absl::StatusOr<ReadResult> read = ReadMeshFile(PathOf(name));
    EXPECT_THAT(read, IsOk());
    return read.ok() ? std::move(read->mesh) : TriangleMesh();
  }
};

TEST_F(Remesh, KeepsTheTopologyInEveryFormat) {
  for (const char* out : {"out.ply", "out.off", "out.obj", "out.stl", "out.glb", "out.gltf"}) {
    const Outcome outcome = Run({"remesh", "in.ply", out});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_EQ(outcome.out + outcome.err, "") << "not silent without a terminal";
    const TriangleMesh mesh = Read(out);
    EXPECT_THAT(mesh, IsClosedManifold()) << out;
    EXPECT_THAT(mesh, HasGenus(1)) << out;
  }
}

TEST_F(Remesh, TellsInStatsWhatIsInTheOutput) {
  const Outcome outcome =
      Run({"remesh", "in.ply", "out.ply", "--rho", "0.6", "--stats", "stats.json", "--trace", "trace.jsonl"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const Json stats = Json::parse(Contents("stats.json"));
  const TriangleMesh mesh = Read("out.ply");
  EXPECT_EQ(stats["output"]["triangles"], mesh.triangles.size());
  EXPECT_EQ(stats["output"]["vertices"], mesh.positions.size());
  EXPECT_EQ(stats["input"]["triangles"], 80 * 40 * 2);
  EXPECT_EQ(stats["parameters"]["rho"], 0.6);
  EXPECT_GE(stats["seconds"]["total"], stats["seconds"]["engine"]);
  EXPECT_GT(stats["seconds"]["engine"], 0);
  const Json& kinds = stats["triangles_by_kind"];
  EXPECT_EQ(kinds["free"].get<int>() + kinds["connection"].get<int>() + kinds["closing"].get<int>(),
            mesh.triangles.size());

  std::istringstream lines(Contents("trace.jsonl"));
  std::string text;
  Json last;
  uint64_t count = 0;
  for (; std::getline(lines, text); ++count) {
    const Json line = Json::parse(text);
    EXPECT_EQ(line["sequence"], count);
    EXPECT_TRUE(last.is_null() || line["triangles"] >= last["triangles"]);
    last = line;
  }
  EXPECT_EQ(count, stats["chunks"]);
  EXPECT_EQ(last["triangles"], mesh.triangles.size());
  EXPECT_EQ(last["vertices"], mesh.positions.size());
  EXPECT_EQ(last["open_front_edges"], 0);
}

// A ring around the outside of the torus, and an arc that ends in the smooth.
TEST_F(Remesh, KeepsTheLinesOfAFile) {
  std::ofstream lines(PathOf("lines.obj"));
  for (int i = 0; i < 24; ++i)
    lines << "v " << 1.4 * std::cos(M_PI * i / 12) << " " << 1.4 * std::sin(M_PI * i / 12) << " 0\n";
  lines << "l";
  for (int i = 0; i <= 24; ++i) lines << " " << i % 24 + 1;
  lines << "\nv 1 0 0.4\nv 0.95 0.31 0.4\nl 25 26\n";
  lines.close();
  const Outcome outcome =
      Run({"remesh", "in.ply", "out.ply", "--features", "lines.obj", "--rho", "0.7", "--stats", "stats.json"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const TriangleMesh mesh = Read("out.ply");
  EXPECT_THAT(mesh, IsClosedManifold());
  EXPECT_THAT(mesh, HasGenus(1));
  const Json stats = Json::parse(Contents("stats.json"));
  EXPECT_EQ(stats["parameters"]["features"], 25);
  EXPECT_EQ(stats["input"]["repairs"][0]["what"], "split_faces_along_features");
  size_t on_ring = 0, at_end = 0;
  for (const Vec3& p : mesh.positions) {
    on_ring += std::abs(p.z) < 1e-9 && std::abs(std::hypot(p.x, p.y) - 1.4) < 0.01;
    at_end += Distance(p, {1, 0, 0.4}) < 1e-6;
  }
  EXPECT_GT(on_ring, 12u);
  EXPECT_EQ(at_end, 1u);
  std::ofstream(PathOf("lines.obj"), std::ios::app) << "v 3 0 0\nl 1 27\n";
  const Outcome refused = Run({"remesh", "in.ply", "out.ply", "--features", "lines.obj"});
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.err, HasSubstr("line 30 of lines.obj"));
}

// Each level by itself is whole, and what a call of its own makes.
TEST_F(Remesh, WritesAFileForEachLevelOfDetail) {
  const Outcome outcome =
      Run({"remesh", "in.ply", "out.ply.gz", "--lod", "0.5,1.2", "--stats", "stats.json", "--trace", "trace.jsonl"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(Files(), ElementsAre("in.ply", "out.lod0.ply.gz", "out.lod1.ply.gz", "stats.json", "trace.jsonl"));
  const Json stats = Json::parse(Contents("stats.json"));
  ASSERT_EQ(stats["lods"].size(), 2u);
  const double rhos[] = {0.5, 1.2};
  for (size_t level = 0; level < 2; ++level) {
    const Json& figures = stats["lods"][level];
    const std::string file = "out.lod" + std::to_string(level) + ".ply.gz";
    const TriangleMesh mesh = Read(file);
    EXPECT_THAT(mesh, IsClosedManifold());
    EXPECT_THAT(mesh, HasGenus(1));
    EXPECT_EQ(figures["file"], file);
    EXPECT_EQ(figures["parameters"]["rho"], rhos[level]);
    EXPECT_EQ(figures["output"]["triangles"], mesh.triangles.size());
    EXPECT_GT(figures["quality"]["radius_ratio_median"], 0.9);
    EXPECT_GT(figures["predicted_triangles"], 0);
    EXPECT_GT(figures["error_bound"], 0);
    EXPECT_GT(figures["seconds"]["mesh"], 0);
  }
  EXPECT_GT(stats["lods"][0]["output"]["triangles"], 2 * stats["lods"][1]["output"]["triangles"].get<int>());
  EXPECT_EQ(stats["output"], stats["lods"][0]["output"]);
  EXPECT_EQ(stats["parameters"]["rho"], 0.5);
  EXPECT_THAT(Contents("trace.jsonl"), HasSubstr(R"("level":1)"));
  ASSERT_EQ(Run({"remesh", "in.ply", "alone.ply", "--rho", "1.2"}).exit_code, 0);
  EXPECT_TRUE(Read("alone.ply").positions == Read("out.lod1.ply.gz").positions);
}

TEST_F(Remesh, WritesOneGltfOfAllLevelsOfDetail) {
  const Outcome outcome = Run({"remesh", "in.ply", "out.gltf", "--lod", "0.5,0.8,1.2", "--stats", "stats.json"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(Files(), ElementsAre("in.ply", "out.gltf", "stats.json"));
  const Json doc = Json::parse(Contents("out.gltf")), stats = Json::parse(Contents("stats.json"));
  const Json& node = doc["nodes"][0];
  ASSERT_EQ(node["extensions"]["MSFT_lod"]["ids"].size(), 2u);
  const std::vector<double> coverages = node["extras"]["MSFT_screencoverage"];
  ASSERT_EQ(coverages.size(), 3u);
  EXPECT_TRUE(coverages[0] > coverages[1] && coverages[1] > coverages[2] && coverages[2] == 0);
  ASSERT_EQ(doc["meshes"].size(), 3u);
  for (size_t level = 0; level < 3; ++level) {
    const Json& primitive = doc["meshes"][level]["primitives"][0];
    const size_t count = doc["accessors"][primitive["indices"].get<size_t>()]["count"];
    EXPECT_EQ(count, 3 * stats["lods"][level]["output"]["triangles"].get<size_t>());
    EXPECT_TRUE(primitive["attributes"].contains("NORMAL"));
  }
  EXPECT_THAT(Read("out.gltf"), IsClosedManifold());
}

// Edges almost as long as the tube is thick do not close.
TEST_F(Remesh, SaysWhichLevelOfDetailIsMeshedInPart) {
  const Outcome outcome = Run({"remesh", "in.ply", "out.ply", "--lod", "0.5,1.5", "--min-edge", "30%", "--max-edge",
                               "80%", "--stats", "stats.json"});
  EXPECT_EQ(outcome.exit_code, 4);
  const Json lods = Json::parse(Contents("stats.json"))["lods"];
  for (size_t level = 0; level < 2; ++level) {
    const std::string number = std::to_string(level);
    EXPECT_TRUE(Exists("out.lod" + number + ".ply"));
    const bool is_told = outcome.err.find("level " + number + " of out.ply is") != std::string::npos;
    EXPECT_EQ(is_told, !lods[level]["output"]["complete"].get<bool>()) << outcome.err;
  }
}

TEST_F(Remesh, WritesNoLevelOfDetailWhereOneCanNotBeWritten) {
  std::filesystem::create_directory(PathOf("out.lod1.ply"));
  EXPECT_EQ(Run({"remesh", "in.ply", "out.ply", "--lod", "0.8,1.2"}).exit_code, 7);
  EXPECT_THAT(Files(), ElementsAre("in.ply", "out.lod1.ply"));
  EXPECT_EQ(Run({"remesh", "in.ply", "-", "--out-format", "ply", "--lod", "0.8,1.2"}).exit_code, 2);
}

// Corners of a face from the smallest on.
std::array<std::array<double, 3>, 3> CornersOf(const TriangleMesh& mesh, const Triangle& t) {
  std::array<std::array<double, 3>, 3> corners;
  for (int i = 0; i < 3; ++i) corners[i] = {mesh.PositionAt(t[i]).x, mesh.PositionAt(t[i]).y, mesh.PositionAt(t[i]).z};
  std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
  return corners;
}

TEST_F(Remesh, LeavesWhatIsBesideARegionBitForBit) {
  const TriangleMesh before = Read("in.ply");
  for (const char* out : {"out.ply", "out.off", "out.obj"}) {
    const Outcome outcome = Run({"remesh", "in.ply", out, "--region", "sphere:1.4,0,0,0.5", "--blend", "6", "--rho",
                                 "0.3", "--stats", "stats.json"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    const TriangleMesh after = Read(out);
    EXPECT_THAT(after, IsClosedManifold());
    EXPECT_THAT(after, HasGenus(1));
    std::set<std::array<std::array<double, 3>, 3>> faces;
    for (const Triangle& t : after.triangles) faces.insert(CornersOf(after, t));
    uint64_t kept = 0;
    for (const Triangle& t : before.triangles) {
      const bool inside = std::all_of(t.begin(), t.end(), [&](VertexId v) {
        return Distance(before.PositionAt(v), {1.4, 0, 0}) <= 0.5;
      });
      if (inside) continue;
      ++kept;
      ASSERT_TRUE(faces.contains(CornersOf(before, t))) << out;
    }
    const Json region = Json::parse(Contents("stats.json"))["region"];
    EXPECT_EQ(region["kept_triangles"], kept);
    EXPECT_EQ(region["replaced_triangles"], before.triangles.size() - kept);
    EXPECT_EQ(region["new_triangles"], after.triangles.size() - kept);
  }
}

TEST_F(Remesh, WritesThePatchAndWhatItReplaces) {
  std::ofstream(PathOf("faces.txt")) << "10\n11\n12\n13\n14\n15\n";
  const Outcome outcome = Run({"remesh", "in.ply", "out.ply", "--region", "faces:faces.txt", "--patch-only",
                               "--removed", "removed.txt", "--max-edge", "0.02"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(Contents("removed.txt"), Contents("faces.txt"));
  const TopologyReport patch = MeasureTopology(Read("out.ply"));
  EXPECT_TRUE(patch.manifold);
  EXPECT_EQ(patch.boundary_loops, 1u);
  EXPECT_EQ(patch.boundary_edges, 8u) << "a strip of six triangles";
  EXPECT_EQ(Run({"estimate", "in.ply", "--region", "faces:faces.txt"}).exit_code, 0);
}

TEST_F(Remesh, WorksInAPipeAndGivesTheSameBytes) {
  ASSERT_EQ(Run({"remesh", "in.ply", "out.off"}).exit_code, 0);
  const Outcome outcome =
      Run({"remesh", "-", "-", "--in-format", "ply", "--out-format", "off", "--threads", "1"}, Contents("in.ply"));
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_TRUE(outcome.out == Contents("out.off"));
}

TEST_F(Remesh, DrawsThePicture) {
  ASSERT_EQ(Run({"remesh", "in.ply", "out.ply", "--picture", "p.png"}).exit_code, 0);
  const std::string bytes = Contents("p.png");
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  ASSERT_TRUE(png_image_begin_read_from_memory(&image, bytes.data(), bytes.size()));
  EXPECT_EQ(image.width, 1600u);
  png_image_free(&image);
}

TEST_F(Remesh, WritesTheRepairedInput) {
  TriangleMesh mesh = Read("in.ply");
  mesh.triangles.push_back({VertexId(0), VertexId(0), VertexId(1)});
  mesh.triangles.push_back(mesh.triangles.front());
  ASSERT_THAT(WriteMeshFile(PathOf("dirty.off"), mesh), IsOk());
  const Outcome outcome =
      Run({"remesh", "dirty.off", "out.ply", "--write-repaired", "repaired.off", "--stats", "stats.json"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(Read("repaired.off"), IsClosedManifold());
  EXPECT_FALSE(Json::parse(Contents("stats.json"))["input"]["repairs"].empty());
  EXPECT_EQ(Run({"remesh", "dirty.off", "no.ply", "--repair", "off"}).exit_code, 3);
  EXPECT_FALSE(Exists("no.ply"));
}

TEST_F(Remesh, MeasuresAgainstTheInput) {
  ASSERT_EQ(Run({"remesh", "in.ply", "out.ply"}).exit_code, 0);
  const Outcome outcome = Run({"measure", "out.ply", "--ref", "in.ply", "--json"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const Json json = Json::parse(outcome.out);
  EXPECT_EQ(json["counts"]["genus"], 1);
  EXPECT_EQ(json["self_intersections"], 0);
  EXPECT_GT(json["quality"]["radius_ratio_median"], 0.9);
  for (const char* way : {"forward", "backward"}) {
    for (const char* key : {"max", "mean", "rms", "max_percent", "mean_percent", "rms_percent"}) {
      EXPECT_TRUE(json["distance"][way][key].is_number()) << way << " " << key;
    }
    EXPECT_LT(json["distance"][way]["max_percent"], 3);
  }
  EXPECT_TRUE(Json::parse(Run({"measure", "out.ply", "--json"}).out)["distance"].is_null());
}

TEST_F(Remesh, EstimatesAboutWhatComesOut) {
  const Outcome outcome = Run({"estimate", "in.ply", "--json"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  ASSERT_EQ(Run({"remesh", "in.ply", "out.ply"}).exit_code, 0);
  const double predicted = Json::parse(outcome.out)["predicted_triangles"];
  EXPECT_NEAR(predicted / Read("out.ply").triangles.size(), 1, 0.25);
}

// A job of minutes. The repaired input is written just before the call begins: from then on the program must end in order.
TEST_F(Remesh, ExitsWithSixWhenInterruptedAndLeavesNothing) {
  for (const int signal : {SIGINT, SIGTERM}) {
    const auto interrupt = [&](int pid) {
      while (!Exists("repaired.ply") && !HasEnded(pid)) std::this_thread::yield();
      kill(pid, signal);
    };
    const Outcome outcome =
        RunWith({"remesh", "in.ply", "out.ply", "--rho", "0.003", "--write-repaired", "repaired.ply"}, interrupt);
    EXPECT_EQ(outcome.exit_code, 6) << outcome.err;
    EXPECT_THAT(Files(), ElementsAre("in.ply", "repaired.ply"));
    std::filesystem::remove(PathOf("repaired.ply"));
  }
}

TEST_F(Remesh, ExitsWithSixPastTheDeadlineAndLeavesNothing) {
  const Outcome outcome = Run({"remesh", "in.ply", "out.ply", "--rho", "0.003", "--timeout", "0.3"});
  EXPECT_EQ(outcome.exit_code, 6) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("--timeout 0.3"));
  const Outcome estimate = Run({"estimate", "in.ply", "--timeout", "0.000001"});
  EXPECT_EQ(estimate.exit_code, 6) << estimate.err;
  EXPECT_THAT(estimate.err, HasSubstr("--timeout 1e-06"));
  EXPECT_THAT(Files(), ElementsAre("in.ply"));
}

// A tetrahedron with a seam at every edge.
constexpr char kTextured[] =
    "mtllib t.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nvt 0 0\nvt 1 0\nvt 0 1\n"
    "f 1/1 3/3 2/2\nf 1/1 2/2 4/3\nf 2/1 3/2 4/3\nf 3/1 1/2 4/3\n";

// glTF has a vertex for each side of a seam; what is closed is closed there too.
TEST_F(Remesh, MeasuresAGltfAcrossItsSeams) {
  std::ofstream(PathOf("textured.obj")) << kTextured;
  ASSERT_EQ(Run({"remesh", "textured.obj", "out.glb"}).exit_code, 0);
  EXPECT_GT(MeasureTopology(Read("out.glb")).boundary_loops, 0u) << "there are seams";
  const Json counts = Json::parse(Run({"measure", "out.glb", "--json"}).out)["counts"];
  EXPECT_EQ(counts["closed"], true);
  EXPECT_EQ(counts["components"], 1);
}

TEST_F(Remesh, WarnsOfFilesThatLieBesideTheInputOnly) {
  std::ofstream(PathOf("textured.obj")) << kTextured;
  std::filesystem::create_directory(PathOf("other"));
  EXPECT_THAT(Run({"remesh", "textured.obj", "other/out.obj"}).err, HasSubstr("not copied: t.mtl"));
  EXPECT_THAT(Run({"remesh", "textured.obj", "./out.obj"}).err, ::testing::Not(HasSubstr("t.mtl")));
}

// An accessor of another length is none of the target's: reading notes that it is lost, and so does writing.
TEST_F(Remesh, SaysOnceThatMorphTargetsAreLost) {
  const TriangleMesh morphing = WithChannel(Icosphere(2), "MORPH_0_POSITION", 3, [](const Vec3& p, const Vec3&) {
    return std::vector<float>{0, 0, static_cast<float>(p.z)};
  });
  std::vector<std::string> left_out;
  const absl::StatusOr<std::string> text = FormatAsset(morphing, Format::kGltf, {}, left_out);
  ASSERT_THAT(text, IsOk());
  Json doc = Json::parse(*text);
  Json& primitive = doc["meshes"][0]["primitives"][0];
  primitive["targets"][0]["POSITION"] = primitive["indices"];
  std::ofstream(PathOf("in.gltf")) << doc.dump();
  const Outcome outcome = Run({"remesh", "in.gltf", "out.glb"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const size_t first = outcome.err.find("not carried over: morph targets");
  ASSERT_NE(first, std::string::npos) << outcome.err;
  EXPECT_EQ(outcome.err.find("not carried over", first + 1), std::string::npos) << outcome.err;
}

TEST_F(Remesh, CarriesTextureCoordinatesUnlessTheyAreDropped) {
  std::ofstream(PathOf("textured.obj")) << kTextured;
  const auto channels_after = [&](const std::vector<std::string>& flags) {
    std::vector<std::string> command = {"remesh", "textured.obj", "out.obj"};
    command.insert(command.end(), flags.begin(), flags.end());
    EXPECT_EQ(Run(command).exit_code, 0);
    const absl::StatusOr<ReadResult> read = ReadMeshFile(PathOf("out.obj"));
    EXPECT_TRUE(read.ok());
    return read.ok() ? read->mesh.attributes.channels : std::vector<AttributeChannel>();
  };
  EXPECT_THAT(channels_after({}), ElementsAre(AttributeChannel{"TEXCOORD_0", 2}));
  EXPECT_THAT(channels_after({"--attributes", "drop"}), ::testing::IsEmpty());
  EXPECT_THAT(Run({"remesh", "textured.obj", "out.stl"}).err, HasSubstr("not carried over: TEXCOORD_0"));
}

}  // namespace
}  // namespace meshfront::testing
