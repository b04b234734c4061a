// The files of the shared test data, where they are there.
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>

#include "core/io/mesh_io.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/support/matchers.h"

namespace meshfront {
namespace {

namespace fs = std::filesystem;

// Beside the checkout; the tests run anywhere below it.
fs::path DataFolder() {
  std::error_code ignored;
  fs::path here = fs::absolute(__FILE__);
  for (; here.has_relative_path(); here = here.parent_path()) {
    const fs::path data = here / ".." / "shared" / "data";
    if (fs::exists(here / "core", ignored) && fs::exists(data / "bad" / "CASES.tsv", ignored)) return data;
  }
  return {};
}

#define SKIP_WITHOUT_DATA() \
  if (DataFolder().empty()) GTEST_SKIP() << "../shared/data is not there"

struct Case {
  std::string file, kind, what;
};
std::vector<Case> Cases() {
  std::ifstream in(DataFolder() / "bad" / "CASES.tsv");
  std::vector<Case> cases;
  std::string line;
  std::getline(in, line);
  while (std::getline(in, line)) {
    std::istringstream row(line);
    Case c;
    std::getline(row, c.file, '\t'), std::getline(row, c.kind, '\t'), std::getline(row, c.what);
    cases.push_back(c);
  }
  return cases;
}

// These are whole files; what is wrong with them is for repair to say.
bool IsForRepairToRefuse(const std::string& file) {
  return file == "zero_area_all.off" || file == "zero_area_one_point.stl" || file == "nan_all.ply";
}

TEST(Corpus, RefusesEveryRejectRowWithASentence) {
  SKIP_WITHOUT_DATA();
  for (const Case& c : Cases()) {
    if (c.kind != "reject" || IsForRepairToRefuse(c.file)) continue;
    const auto read = ReadMeshFile((DataFolder() / "bad" / c.file).string());
    EXPECT_EQ(read.status().code(), absl::StatusCode::kInvalidArgument) << c.file << ": " << c.what << "\n"
                                                                        << read.status();
    EXPECT_NE(read.status().message().find(c.file), std::string::npos) << read.status();
  }
}

TEST(Corpus, ReadsEveryOtherRow) {
  SKIP_WITHOUT_DATA();
  for (const Case& c : Cases()) {
    if (c.kind == "reject" && !IsForRepairToRefuse(c.file)) continue;
    const auto read = ReadMeshFile((DataFolder() / "bad" / c.file).string());
    EXPECT_TRUE(read.ok()) << c.file << ": " << c.what << "\n" << read.status();
  }
}

// The manifest was counted by another reader. Vertices are not compared where it counted before welding (STL).
TEST(Corpus, ReadsEveryGoodFileWithTheTrianglesOfTheManifest) {
  SKIP_WITHOUT_DATA();
  std::ifstream in(DataFolder() / "MANIFEST.tsv");
  std::string line;
  int compared = 0;
  while (std::getline(in, line)) {
    std::istringstream row(line);
    std::string file, skipped, vertices, triangles;
    std::getline(row, file, '\t');
    for (int i = 0; i < 3; ++i) std::getline(row, skipped, '\t');
    std::getline(row, vertices, '\t'), std::getline(row, triangles, '\t');
    const Format format = FormatOfName(file);
    if (file.starts_with("bad/") || file.starts_with("gen/") || format == Format::kUnknown) continue;
    const auto read = ReadMeshFile((DataFolder() / file).string());
    if (file == "open/beetle_binary.off") {
      EXPECT_THAT(read, testing::StatusIs(absl::StatusCode::kInvalidArgument, "binary OFF is not read"));
      continue;
    }
    ASSERT_TRUE(read.ok()) << read.status();
    if (triangles.empty() || !std::isdigit(static_cast<unsigned char>(triangles[0]))) continue;
    EXPECT_EQ(std::to_string(read->mesh.triangles.size()), triangles) << file;
    if (format != Format::kStl) {
      EXPECT_EQ(std::to_string(read->mesh.positions.size()), vertices) << file;
    }
    ++compared;
  }
  EXPECT_GE(compared, 50);
}

TEST(Corpus, ReadsOrRefusesWhatWasFoundInTheWild) {
  SKIP_WITHOUT_DATA();
  const std::set<std::string> refused = {"IndexOutOfRange.gltf", "OutOfMemory.off", "invalid.off", "malformed.obj"};
  for (const auto& entry : fs::directory_iterator(DataFolder() / "bad" / "found")) {
    const auto read = ReadMeshFile(entry.path().string());
    EXPECT_EQ(read.ok(), !refused.contains(entry.path().filename().string())) << entry.path() << " " << read.status();
    if (!read.ok()) {
      EXPECT_EQ(read.status().code(), absl::StatusCode::kInvalidArgument) << read.status();
    }
  }
}

}  // namespace
}  // namespace meshfront
