// The command line as scripts see it: exit codes, and nothing left behind by a failure.
#include <signal.h>
#include <sys/stat.h>

#include <filesystem>
#include <fstream>

#include "core/io/mesh_io.h"
#include "gmock/gmock.h"
#include "tests/client/program.h"
#include "tests/support/matchers.h"
#include "tests/support/shapes.h"

namespace meshfront::testing {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::StartsWith;

class Program : public ProgramTest {
 protected:
  void WriteSphere(const std::string& name, int subdivisions = 3) const {
    ASSERT_THAT(WriteMeshFile(PathOf(name), Icosphere(subdivisions)), IsOk());
  }
};

TEST_F(Program, PrintsItsVersion) {
  const Outcome outcome = Run({"version"});
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_THAT(outcome.out, StartsWith("meshfront "));
}

TEST_F(Program, ExplainsItselfWhenAsked) {
  EXPECT_EQ(Run({"--help"}).exit_code, 0);
  const Outcome outcome = Run({"remesh", "--help"});
  EXPECT_EQ(outcome.exit_code, 0);
  for (const char* flag : {"--server",          "--rho",       "--eta",
                           "--max-error",       "--sizing",    "--target-triangles",
                           "--edge-length",     "--min-edge",  "--max-edge",
                           "--crease-angle",    "--features",  "--attributes",
                           "--region",          "--blend",     "--surface",
                           "--mls-radius",      "--fill-gaps", "--seed-point",
                           "--flips",           "--smooth",    "--fit",
                           "--threads",         "--repair",    "--stats",
                           "--trace",           "--picture",   "--write-repaired",
                           "--patch-only",      "--removed",   "--timeout",
                           "--keep-session",    "--session",   "--update-session",
                           "--quiet",           "--in-format", "--out-format",
                           "--session-revision"}) {
    EXPECT_THAT(outcome.out, HasSubstr(flag));
  }
}

TEST_F(Program, ExitsWithTwoForMistakesInTheCommandLine) {
  WriteSphere("in.ply");
  std::ofstream(PathOf("points.xyz")) << "0 0 0\n1 0 0\n0 1 0\n";
  const std::string before = Contents("in.ply");
  const std::vector<std::vector<std::string>> mistakes = {
      {},
      {"remsh"},
      {"remesh"},
      {"remesh", "in.ply"},
      {"remesh", "in.ply", "out.ply", "more.ply"},
      {"remesh", "in.ply", "out.ply", "--bogus"},
      {"remesh", "in.ply", "out.ply", "--rho"},
      {"remesh", "in.ply", "out.ply", "--rho", "9"},
      {"remesh", "in.ply", "out.ply", "--region", "sphere:0,0,0"},
      {"remesh", "in.ply", "out.ply", "--region", "sphere:9,9,9,1"},
      {"remesh", "in.ply", "out.ply", "--region", "faces:missing.txt"},
      {"remesh", "in.ply", "out.ply", "--blend", "8"},
      {"remesh", "in.ply", "out.ply", "--patch-only"},
      {"remesh", "in.ply", "out.ply", "--region", "box:0,0,0,9,9,9", "--removed", "removed.txt"},
      {"remesh", "in.ply", "out.ply", "--rho", "-1"},
      {"remesh", "in.ply", "out.ply", "--rho", "1", "--edge-length", "1"},
      {"remesh", "in.ply", "out.ply", "--max-error", "1%", "--target-triangles", "500"},
      {"remesh", "in.ply", "out.ply", "--max-error", "1%", "--sizing", "uniform"},
      {"remesh", "in.ply", "out.ply", "--target-triangles", "4", "--max-edge", "1%"},  // too few for such edges
      {"remesh", "in.ply", "out.doc"},
      {"remesh", "in.ply", "out.xyz"},
      {"remesh", "-", "out.ply"},
      {"remesh", "in.ply", "-"},
      {"remesh", "in.ply", "out.ply", "--server", "nowhere"},
      {"remesh", "in.ply", "out.ply", "--server", "127.0.0.1:99999"},
      {"remesh", "in.ply", "out.ply", "--timeout", "0"},
      {"remesh", "in.ply", "out.ply", "--session-revision", "1"},  // of which session
      {"remesh", "in.ply", "out.ply", "--write-repaired", "in.xyz"},
      {"remesh", "in.ply", "out.ply", "--picture", "picture.jpg"},
      {"remesh", "in.ply", "out.ply", "--write-repaired", "./out.ply"},
      {"remesh", "in.ply", "out.ply", "--stats", "out.ply"},
      {"remesh", "in.ply", "out.ply", "--stats", "in.ply"},
      {"remesh", "in.ply", "out.ply", "--write-repaired", "./in.ply"},
      {"remesh", "in.ply", "in.ply", "--region", "faces:in.ply"},
      {"remesh", "points.xyz", "out.ply", "--write-repaired", "repaired.ply"},
      {"remesh", "in.ply", "out.ply", "--stats", "-", "--trace", "-"},
      {"estimate"},
      {"measure"},
      {"render", "in.ply"},
      {"render", "in.ply", "picture.jpg"},
      {"render", "in.ply", "picture.png", "--size", "15"},
      {"render", "in.ply", "picture.png", "--size", "9000"},
      {"render", "in.ply", "picture.png", "--zoom", "0"},
      {"render", "in.ply", "picture.png", "--zoom", "nan"},
      {"render", "in.ply", "picture.png", "--zoom", "1e-4"},
      {"render", "in.ply", "picture.png", "--zoom", "1e7"},
      {"render", "in.ply", "picture.png", "--view-of", "-"},
      {"render", "in.ply", "picture.png", "--at", "1,2"},
      {"render", "in.ply", "picture.png", "--up", "x"},
      {"render", "in.ply", "picture.png", "--at", "1,2,x"},
      {"info"}};
  for (const std::vector<std::string>& arguments : mistakes) {
    const Outcome outcome = Run(arguments);
    EXPECT_EQ(outcome.exit_code, 2) << ::testing::PrintToString(arguments);
    EXPECT_THAT(outcome.err, StartsWith("meshfront: ")) << ::testing::PrintToString(arguments);
  }
  EXPECT_THAT(Files(), ElementsAre("in.ply", "points.xyz"));
  EXPECT_EQ(Contents("in.ply"), before);
}

TEST_F(Program, NamesASubcommandThatItDoesNotKnow) { EXPECT_THAT(Run({"bogus", "in.ply"}).err, HasSubstr("bogus")); }

TEST_F(Program, SaysNotYetToWhatIsNotBuilt) {
  WriteSphere("in.ply");
  const std::vector<std::vector<std::string>> not_built = {
      {"union", "in.ply", "in.ply", "out.ply"},
      {"intersection", "in.ply", "in.ply", "out.ply"},
      {"difference", "in.ply", "in.ply", "out.ply"},
      {"cut", "in.ply", "in.ply", "out.ply"},
      {"estimate", "in.ply", "--surface", "mls", "--region", "sphere:0,0,0,1"}};
  for (const std::vector<std::string>& arguments : not_built) {
    const Outcome outcome = Run(arguments);
    EXPECT_EQ(outcome.exit_code, 2) << ::testing::PrintToString(arguments);
    EXPECT_THAT(outcome.err, HasSubstr("not yet")) << ::testing::PrintToString(arguments);
  }
  EXPECT_THAT(Files(), ElementsAre("in.ply"));
}

TEST_F(Program, ExitsWithThreeForAnInputThatCannotBeRead) {
  std::ofstream(PathOf("bad.off")) << "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 7\n";
  for (const char* input : {"missing.ply", "bad.off"}) {
    const Outcome outcome = Run({"remesh", input, "out.ply"});
    EXPECT_EQ(outcome.exit_code, 3) << input;
    EXPECT_THAT(outcome.err, HasSubstr(input));
  }
  EXPECT_EQ(Run({"info", "missing.ply"}).exit_code, 3);
  EXPECT_EQ(Run({"estimate", "missing.ply"}).exit_code, 3);
  EXPECT_EQ(Run({"measure", "missing.ply"}).exit_code, 3);
  EXPECT_THAT(Files(), ElementsAre("bad.off"));
}

TEST_F(Program, NamesTheFileAndThePlaceOfWhatCannotBeMeshed) {
  std::ofstream(PathOf("line.off")) << "OFF\n3 1 0\n1 2 3\n2 2 3\n3 2 3\n3 0 1 2\n";
  std::ofstream(PathOf("nan.off")) << "OFF\n3 1 0\nnan 2 3\n2 2 3\n3 2 3\n3 0 1 2\n";
  for (const auto& [file, place] : {std::pair{"line.off", "triangle 0 at (1, 2, 3)"}, {"nan.off", "vertex 0"}}) {
    for (const std::vector<std::string>& arguments :
         {std::vector<std::string>{"remesh", file, "out.ply"}, {"estimate", file}}) {
      const Outcome outcome = Run(arguments);
      EXPECT_EQ(outcome.exit_code, 3) << outcome.err;
      EXPECT_THAT(outcome.err, HasSubstr(file));
      EXPECT_THAT(outcome.err, HasSubstr(place));
    }
  }
  EXPECT_THAT(Files(), ElementsAre("line.off", "nan.off"));
}

// A coordinate that is not finite has no place; a vertex that no triangle names is worth a note.
TEST_F(Program, DescribesWhatHasNoPlaceByItsNumber) {
  std::ofstream(PathOf("odd.off")) << "OFF\n5 2 0\n0 0 0\n1 0 0\n0 1 0\n0 nan 0\n9 9 9\n3 0 1 2\n3 0 2 3\n";
  const Outcome outcome = Run({"info", "odd.off"});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("vertex 3 of triangle 1"));
  EXPECT_THAT(outcome.out, Not(HasSubstr("nan")));
  EXPECT_THAT(outcome.out, HasSubstr("1 unreferenced vertices"));
}

TEST_F(Program, WritesNoEmptyMesh) {
  const TriangleMesh flat = Mapped(UvSphere(20, 18), [](const Vec3& p) { return Vec3{1e8 * p.x, p.y, p.z}; });
  ASSERT_THAT(WriteMeshFile(PathOf("flat.off"), flat), IsOk());
  const Outcome outcome = Run({"remesh", "flat.off", "out.off"});
  EXPECT_EQ(outcome.exit_code, 3) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("flat.off: not one triangle could be meshed"));
  EXPECT_THAT(Files(), ElementsAre("flat.off"));
}

// 150 MB of points at the origin, which take 300 MB as doubles.
TEST_F(Program, ExitsWithSeventyAndASentenceWhenThereIsNotEnoughMemory) {
  constexpr uint64_t points = 12'500'000, bytes = 12 * points;
  std::ofstream file(PathOf("large.ply"));
  file << "ply\nformat binary_little_endian 1.0\nelement vertex " << points
       << "\nproperty float x\nproperty float y\nproperty float z\nend_header\n";
  const auto header = static_cast<uint64_t>(file.tellp());
  file.close();
  std::filesystem::resize_file(PathOf("large.ply"), header + bytes);
  for (const uint64_t limit : {100ull << 20, 400ull << 20}) {  // too little for the file, and for what is in it
    const Outcome outcome = RunWithin(limit, {"info", "large.ply"});
    EXPECT_EQ(outcome.exit_code, 70);
    EXPECT_THAT(outcome.err, HasSubstr("memory"));
  }
}

TEST_F(Program, ExitsWithFiveWhenNobodyListens) {
  WriteSphere("in.ply");
  const Outcome estimate = Run({"estimate", "in.ply", "--server", "127.0.0.1:1"});
  EXPECT_EQ(estimate.exit_code, 5);
  EXPECT_THAT(estimate.err, HasSubstr("server 127.0.0.1:1: "));
  const Outcome outcome = Run({"remesh", "in.ply", "out.ply", "--server", "127.0.0.1:1"});
  EXPECT_EQ(outcome.exit_code, 5);
  EXPECT_THAT(outcome.err, HasSubstr("127.0.0.1:1"));
  EXPECT_THAT(Files(), ElementsAre("in.ply"));
}

TEST_F(Program, ExitsWithSevenBeforeTheWorkWhenOutCannotBeWritten) {
  WriteSphere("in.ply");
  EXPECT_EQ(Run({"remesh", "in.ply", "no/folder/out.ply"}).exit_code, 7);
  EXPECT_EQ(Run({"remesh", "in.ply", "out.ply", "--stats", "no/folder/stats.json"}).exit_code, 7);
  EXPECT_EQ(Run({"remesh", "in.ply", "out.ply", "--picture", "no/folder/p.png"}).exit_code, 7);
  // Were the input read first, this would be 3.
  EXPECT_EQ(Run({"remesh", "missing.ply", "no/folder/out.ply"}).exit_code, 7);
  EXPECT_THAT(Files(), ElementsAre("in.ply"));
}

TEST_F(Program, DescribesWhatIsInAFileAndWhatIsWrongWithIt) {
  WriteSphere("in.ply", 2);
  const Outcome whole = Run({"info", "in.ply"});
  EXPECT_EQ(whole.exit_code, 0);
  EXPECT_THAT(whole.out, HasSubstr("320 triangles"));
  EXPECT_THAT(whole.out, HasSubstr("genus 0"));
  EXPECT_THAT(whole.out, HasSubstr("defects     none"));
  // Three faces on the edge from (0, 0, 0) to (1, 0, 0).
  std::ofstream(PathOf("book.off")) << "OFF\n5 3 0\n0 0 0\n1 0 0\n0 1 0\n0 -1 0\n0 0 1\n3 0 1 2\n3 1 0 3\n3 0 1 4\n";
  const Outcome book = Run({"info", "book.off"});
  EXPECT_EQ(book.exit_code, 0);
  EXPECT_THAT(book.out, HasSubstr("not manifold"));
  EXPECT_THAT(book.out, HasSubstr("non_manifold_edge"));
}

TEST_F(Program, RendersAMeshOfTheSizeThatIsAskedFor) {
  WriteSphere("in.ply");
  ASSERT_EQ(Run({"render", "in.ply", "picture.png", "--size", "300"}).exit_code, 0);
  const std::string png = Contents("picture.png");
  ASSERT_GT(png.size(), 24u);
  EXPECT_EQ(png.substr(1, 3), "PNG");
  EXPECT_EQ(png.substr(16, 8), std::string("\0\0\1\x2c\0\0\1\x2c", 8));  // width and height, big-endian
  EXPECT_EQ(Run({"render", "missing.ply", "none.png"}).exit_code, 3);
  EXPECT_EQ(Run({"render", "in.ply", "missing/none.png"}).exit_code, 7);
  EXPECT_THAT(Files(), ElementsAre("in.ply", "picture.png"));
}

TEST_F(Program, RendersWhatIsSmallerAsSmallInTheViewOfTheWhole) {
  WriteSphere("whole.ply");
  const TriangleMesh part = Mapped(Icosphere(3), [](const Vec3& p) { return 0.5 * p; });
  ASSERT_THAT(WriteMeshFile(PathOf("part.ply"), part), IsOk());
  const auto rendered = [this](const std::vector<std::string>& more) {
    std::vector<std::string> arguments = {"render", "part.ply", "out.png", "--size", "64"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    EXPECT_EQ(Run(arguments).exit_code, 0);
    return Contents("out.png");
  };
  const std::string alone = rendered({});
  EXPECT_NE(rendered({"--view-of", "whole.ply"}), alone);
  EXPECT_EQ(rendered({"--view-of", "whole.ply", "--zoom", "2"}), alone);
  EXPECT_EQ(rendered({"--at", "0,0,0"}), alone);
  EXPECT_NE(rendered({"--up", "y"}), rendered({"--up", "z"}));
  EXPECT_NE(rendered({"--at=-0.5,0,0"}), alone);
}

// All points but the one in the middle lie outside, at pixels that no int can count.
TEST_F(Program, RendersOnePointOfASetFromVeryClose) {
  std::ofstream(PathOf("all.xyz")) << "0 0 1\n0 0 -1\n1 0 0\n-1 0 0\n0 1e300 0\n-1e300 0 0\n";
  std::ofstream(PathOf("one.xyz")) << "0 0 1\n";
  std::ofstream(PathOf("none.xyz")) << "9 9 9\n";
  WriteSphere("view.ply");
  const auto rendered = [this](const std::string& in) {
    EXPECT_EQ(Run({"render", in, "out.png", "--view-of", "view.ply", "--at", "0,0,1", "--zoom", "1e6"}).exit_code, 0);
    return Contents("out.png");
  };
  EXPECT_EQ(rendered("all.xyz"), rendered("one.xyz"));
  EXPECT_NE(rendered("one.xyz"), rendered("none.xyz"));
}

TEST_F(Program, RendersNothingInTheViewOfStandardInput) {
  WriteSphere("in.ply");
  for (const char* in : {"in.ply", "-"}) {
    const Outcome outcome = Run({"render", in, "out.png", "--view-of", "-", "--in-format", "ply"}, Contents("in.ply"));
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_THAT(outcome.err, HasSubstr("--view-of is -; it must be a file"));
  }
  EXPECT_THAT(Files(), ElementsAre("in.ply"));
}

TEST_F(Program, WarnsOfWhatIsOddInTheFileThatGivesTheView) {
  std::ofstream(PathOf("odd.off")) << "OFF\n3 2 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n2 0 1\n";
  WriteSphere("in.ply");
  const Outcome outcome = Run({"render", "in.ply", "out.png", "--view-of", "odd.off"});
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_THAT(outcome.err, HasSubstr("meshfront: warning: "));
  EXPECT_THAT(outcome.err, HasSubstr("fewer than three corners"));
}

TEST_F(Program, WritesTheSampleInTheFormatOfItsName) {
  EXPECT_EQ(Run({"sample", "s.obj"}).exit_code, 0);
  const absl::StatusOr<ReadResult> read = ReadMeshFile(PathOf("s.obj"));
  ASSERT_THAT(read, IsOk());
  EXPECT_THAT(read->mesh, IsClosedManifold());
  EXPECT_EQ(Run({"sample", "s.doc"}).exit_code, 2);
}

}  // namespace
}  // namespace meshfront::testing
