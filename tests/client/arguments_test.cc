// Flags and what they mean: every mistake one sentence with the flag, the value and the rule.
#include "client/cli/arguments.h"

#include "client/cli/feature_lines.h"

#include <cmath>
#include <fstream>

#include "tests/support/matchers.h"

namespace meshfront {
namespace {

using testing::IsOk;
using testing::StatusIs;

constexpr auto kInvalid = absl::StatusCode::kInvalidArgument;

absl::Status Parse(const MeshingFlags& flags) { return ParseMeshingFlags(flags).status(); }

TEST(MeshingFlags, SendOnlyTheSizingWhenNoneIsGiven) {
  const absl::StatusOr<v1::RemeshOptions> options = ParseMeshingFlags({});
  ASSERT_THAT(options, IsOk());
  EXPECT_FALSE(options->has_rho() || options->has_eta() || options->has_flips() || options->has_crease() ||
               options->has_attributes() || options->has_threads());
  EXPECT_EQ(options->sizing(), v1::SIZING_ANGLE);
}

TEST(MeshingFlags, CarryEveryValueThatIsBuilt) {
  MeshingFlags flags;
  flags.eta = "1.5", flags.edge_length = "0.25", flags.min_edge = "1%", flags.max_edge = "7", flags.flips = "off";
  flags.smooth = "on", flags.fit = "off", flags.repair = "off", flags.threads = "3", flags.crease_angle = "off";
  flags.attributes = "drop", flags.surface = "mesh";
  const absl::StatusOr<v1::RemeshOptions> options = ParseMeshingFlags(flags);
  ASSERT_THAT(options, IsOk());
  EXPECT_EQ(options->eta(), 1.5);
  EXPECT_EQ(options->sizing(), v1::SIZING_UNIFORM);
  EXPECT_EQ(options->edge_length().absolute(), 0.25);
  EXPECT_EQ(options->min_edge().diagonal_fraction(), 0.01);
  EXPECT_EQ(options->max_edge().absolute(), 7);
  EXPECT_TRUE(options->has_flips() && !options->flips() && options->smooth() && !options->fit() && !options->repair());
  EXPECT_EQ(options->threads(), 3u);
  EXPECT_TRUE(options->crease().off());
  EXPECT_EQ(options->attributes(), v1::ATTRIBUTE_POLICY_DROP);
  EXPECT_EQ(options->surface(), v1::SURFACE_TYPE_MESH);
}

TEST(MeshingFlags, CarryTheOneParameterOfTheSizing) {
  const absl::StatusOr<v1::RemeshOptions> error = ParseMeshingFlags({.max_error = "0.5%"});
  ASSERT_THAT(error, IsOk());
  EXPECT_EQ(error->sizing(), v1::SIZING_ERROR);
  EXPECT_DOUBLE_EQ(error->max_error().diagonal_fraction(), 0.005);
  const absl::StatusOr<v1::RemeshOptions> unset = ParseMeshingFlags({.sizing = "error"});
  ASSERT_THAT(unset, IsOk());
  EXPECT_EQ(unset->sizing(), v1::SIZING_ERROR);
  EXPECT_FALSE(unset->has_max_error() || unset->has_rho());
}

TEST(MeshingFlags, TakeALevelOfDetailForEachRho) {
  const absl::StatusOr<v1::RemeshOptions> options = ParseMeshingFlags({.lod = "0.3,0.8,1.5"});
  ASSERT_THAT(options, IsOk());
  EXPECT_EQ(std::vector<double>(options->lod_rhos().begin(), options->lod_rhos().end()),
            (std::vector<double>{0.3, 0.8, 1.5}));
  EXPECT_FALSE(options->has_rho());
  for (const char* text : {"", "0.3,", "0.3,x", "0.8,0.3", "0.3,0.3", "0", "0.5,2.2"})
    EXPECT_THAT(Parse({.lod = text}), StatusIs(kInvalid, "--lod")) << text;
  std::string many = "0.1";
  for (int i = 1; i < 17; ++i) many += "," + std::to_string(0.1 + 0.1 * i);
  EXPECT_THAT(Parse({.lod = many}), StatusIs(kInvalid, "at most 16"));
}

TEST(MeshingFlags, RefuseLevelsOfDetailBesideWhatElseSizes) {
  const std::vector<MeshingFlags> others = {
      {.rho = "1", .lod = "1"},         {.lod = "1", .max_error = "1%"},
      {.lod = "1", .sizing = "error"},  {.lod = "1", .target_triangles = "100"},
      {.lod = "1", .edge_length = "1"}, {.lod = "1", .region = "sphere:0,0,0,1"},
  };
  for (const MeshingFlags& flags : others) EXPECT_THAT(Parse(flags), StatusIs(kInvalid, "contradict"));
}

TEST(MeshingFlags, SolveForACountUnderAnySizing) {
  using Wanted = std::pair<MeshingFlags::Text, v1::Sizing>;
  for (const auto& [sizing, wanted] : {Wanted{std::nullopt, v1::SIZING_ANGLE}, Wanted{"angle", v1::SIZING_ANGLE},
                                       Wanted{"error", v1::SIZING_ERROR}, Wanted{"uniform", v1::SIZING_UNIFORM}}) {
    const absl::StatusOr<v1::RemeshOptions> options =
        ParseMeshingFlags({.sizing = sizing, .target_triangles = "34200"});
    ASSERT_THAT(options, IsOk());
    EXPECT_EQ(options->sizing(), wanted);
    EXPECT_EQ(options->target_triangles(), 34200u);
    EXPECT_FALSE(options->has_rho() || options->has_max_error() || options->has_edge_length());
  }
}

TEST(MeshingFlags, NameTheFlagTheValueAndTheRule) {
  EXPECT_THAT(Parse({.rho = "3"}), StatusIs(kInvalid, "--rho is 3; it must be a number in (0, 2π/3]"));
  for (const char* wrong : {"0", "-1", "nan", "inf", "1x", "", "2.0944"}) {
    EXPECT_THAT(Parse({.rho = wrong}), StatusIs(kInvalid, "--rho")) << wrong;
  }
  for (const char* wrong : {"1", "2", "x"})
    EXPECT_THAT(Parse({.eta = wrong}), StatusIs(kInvalid, "--eta is ")) << wrong;
  for (const char* wrong : {"0", "-2%", "%", "1%%", "inf"}) {
    EXPECT_THAT(Parse({.edge_length = wrong}), StatusIs(kInvalid, "--edge-length is ")) << wrong;
  }
  EXPECT_THAT(Parse({.flips = "yes"}), StatusIs(kInvalid, "--flips is yes; it must be on or off"));
  EXPECT_THAT(Parse({.threads = "-1"}), StatusIs(kInvalid, "--threads is -1"));
  EXPECT_THAT(Parse({.sizing = "round"}), StatusIs(kInvalid, "--sizing is round"));
  EXPECT_THAT(Parse({.attributes = "some"}), StatusIs(kInvalid, "--attributes is some"));
  for (const char* wrong : {"3", "-5", "1e4", "2.5", ""}) {
    EXPECT_THAT(Parse({.target_triangles = wrong}), StatusIs(kInvalid, "--target-triangles is ")) << wrong;
  }
  for (const char* wrong : {"0", "-1", "0%", "x"}) {
    EXPECT_THAT(Parse({.max_error = wrong}), StatusIs(kInvalid, "--max-error is ")) << wrong;
  }
}

TEST(MeshingFlags, TakeAnAngleForTheThicknessToo) {
  const absl::StatusOr<v1::RemeshOptions> options = ParseMeshingFlags({.rho = "0.5", .sizing = "thickness"});
  ASSERT_THAT(options, IsOk());
  EXPECT_EQ(options->sizing(), v1::SIZING_THICKNESS);
  EXPECT_EQ(options->rho(), 0.5);
}

TEST(MeshingFlags, RefuseContradictions) {
  EXPECT_THAT(Parse({.rho = "0.5", .edge_length = "1"}), StatusIs(kInvalid, "--rho and --edge-length contradict"));
  EXPECT_THAT(Parse({.rho = "0.5", .max_error = "1%"}), StatusIs(kInvalid, "contradict"));
  EXPECT_THAT(Parse({.max_error = "1", .target_triangles = "500"}), StatusIs(kInvalid, "contradict"));
  EXPECT_THAT(Parse({.rho = "0.5", .target_triangles = "500"}), StatusIs(kInvalid, "contradict"));
  EXPECT_THAT(Parse({.target_triangles = "500", .edge_length = "1"}), StatusIs(kInvalid, "contradict"));
  EXPECT_THAT(Parse({.max_error = "1", .edge_length = "1"}), StatusIs(kInvalid, "contradict"));
  EXPECT_THAT(Parse({.rho = "0.5", .sizing = "uniform"}), StatusIs(kInvalid, "--rho and --sizing uniform"));
  EXPECT_THAT(Parse({.rho = "0.5", .sizing = "error"}), StatusIs(kInvalid, "--rho and --sizing error"));
  EXPECT_THAT(Parse({.max_error = "1%", .sizing = "thickness"}), StatusIs(kInvalid, "--max-error and --sizing thick"));
  EXPECT_THAT(Parse({.max_error = "1%", .sizing = "angle"}), StatusIs(kInvalid, "--max-error and --sizing angle"));
  EXPECT_THAT(Parse({.sizing = "error", .edge_length = "1"}), StatusIs(kInvalid, "--edge-length and --sizing error"));
  EXPECT_THAT(Parse({.sizing = "angle", .edge_length = "1"}), StatusIs(kInvalid, "--edge-length and --sizing angle"));
  EXPECT_THAT(Parse({.sizing = "uniform"}), StatusIs(kInvalid, "--edge-length"));
  EXPECT_THAT(Parse({.min_edge = "2%", .max_edge = "1%"}), StatusIs(kInvalid, "--min-edge is larger"));
}

TEST(MeshingFlags, CarryTheSurfaceOfAPointSet) {
  const absl::StatusOr<v1::RemeshOptions> options = ParseMeshingFlags({.surface = "imls", .mls_radius = "3.5"});
  ASSERT_THAT(options, IsOk());
  EXPECT_EQ(options->surface(), v1::SURFACE_TYPE_IMLS);
  EXPECT_EQ(options->mls_radius(), 3.5);
  EXPECT_EQ(ParseMeshingFlags({.surface = "mls"})->surface(), v1::SURFACE_TYPE_MLS);
}

TEST(MeshingFlags, GapsAreFilledUpToALength) {
  EXPECT_EQ(ParseMeshingFlags({.fill_gaps = "0.25"})->fill_gaps().absolute(), 0.25);
  EXPECT_DOUBLE_EQ(ParseMeshingFlags({.fill_gaps = "5%"})->fill_gaps().diagonal_fraction(), 0.05);
  EXPECT_FALSE(ParseMeshingFlags({})->has_fill_gaps());
  EXPECT_THAT(Parse({.fill_gaps = "0"}), StatusIs(kInvalid, "--fill-gaps is 0"));
  EXPECT_THAT(Parse({.fill_gaps = "wide"}), StatusIs(kInvalid, "--fill-gaps"));
  EXPECT_THAT(Parse({.region = "sphere:0,0,0,1", .fill_gaps = "1"}), StatusIs(kInvalid, "--fill-gaps and --region"));
}

TEST(MeshingFlags, ACreaseAngleIsDegrees) {
  EXPECT_EQ(ParseMeshingFlags({.crease_angle = "25.5"})->crease().angle_degrees(), 25.5);
  EXPECT_THAT(Parse({.crease_angle = "180"}), StatusIs(kInvalid, "--crease-angle is 180"));
}

TEST(MeshingFlags, ARegionIsABallABoxOrAFileOfFaces) {
  const v1::RemeshOptions ball = *ParseMeshingFlags({.region = "sphere:1,-2,3e2,0.5", .blend = "4"});
  EXPECT_EQ(ball.region().sphere().center().z(), 300);
  EXPECT_EQ(ball.region().sphere().radius(), 0.5);
  EXPECT_EQ(ball.blend(), 4);
  const v1::Region box = ParseMeshingFlags({.region = "box:0,1,2,3,4,5"})->region();
  EXPECT_EQ(box.box().min().y(), 1);
  EXPECT_EQ(box.box().max().x(), 3);
  EXPECT_THAT(Parse({.region = "faces:a.txt"}), IsOk());
  for (const char* wrong : {"", "ball:1", "faces:", "sphere:0,0,0,0", "sphere:0,0,0,1,1", "sphere:0,0,x,1",
                            "sphere:0,0,nan,1", "box:0,0,0,1,1", "box:1,0,0,0,1,1"}) {
    EXPECT_THAT(Parse({.region = wrong}), StatusIs(kInvalid, "--region is ")) << wrong;
  }
  EXPECT_THAT(Parse({.blend = "8"}), StatusIs(kInvalid, "--blend needs --region"));
  EXPECT_THAT(Parse({.region = "faces:a.txt", .blend = "-1"}), StatusIs(kInvalid, "--blend is -1"));
}

TEST(MeshingFlags, FacesAreNumbersOneALine) {
  const std::string path = ::testing::TempDir() + "faces.txt";
  std::ofstream(path) << "7\n\n 12 \r\n0\n";
  EXPECT_EQ(*ReadRegionFaces("faces:" + path), (std::vector<uint32_t>{7, 12, 0}));
  std::ofstream(path) << "7\n-1\n";
  EXPECT_THAT(ReadRegionFaces("faces:" + path), StatusIs(kInvalid, "\"-1\" in line 2"));
  std::ofstream(path) << "\n";
  EXPECT_THAT(ReadRegionFaces("faces:" + path), StatusIs(kInvalid, "names no face"));
  EXPECT_THAT(ReadRegionFaces("faces:/no/such/file"), StatusIs(kInvalid, "can't be read"));
  EXPECT_TRUE(ReadRegionFaces("sphere:0,0,0,1")->empty());
}

TEST(MeshingFlags, FeaturesAreTheLinesOfAnObj) {
  const std::string path = ::testing::TempDir() + "lines.obj";
  std::ofstream(path) << "# a line\nv 0 0 0\nv 1 0 0 1\r\nl 1 2\nv 1 1 0\nl 1/1 2/2 -1\nf 1 2 3\n";
  const absl::StatusOr<FeatureLines> read = ReadFeatureLines(path);
  ASSERT_THAT(read, IsOk());
  EXPECT_EQ(read->lines.points.size(), 3u);
  EXPECT_EQ(read->lines.segments, (std::vector<std::array<uint32_t, 2>>{{0, 1}, {0, 1}, {1, 2}}));
  EXPECT_EQ(read->numbers, (std::vector<uint64_t>{4, 6, 6}));
  EXPECT_THAT(WithFeatureLine(absl::InvalidArgumentError("options.features.segments[2] lies at"), "lines.obj", *read),
              StatusIs(kInvalid, "(line 6 of lines.obj)"));
  for (const char* line : {"v 1 2", "v 1 2 nan", "l 1", "l 1 4", "l 0 1", "l 1 x"}) {
    std::ofstream(path) << "v 0 0 0\nv 1 0 0\n" << line << "\n";
    EXPECT_THAT(ReadFeatureLines(path), StatusIs(kInvalid, "in line 3")) << line;
  }
  std::ofstream(path) << "v 0 0 0\n";
  EXPECT_THAT(ReadFeatureLines(path), StatusIs(kInvalid, "has no line"));
  EXPECT_THAT(ReadFeatureLines("/no/such/file"), StatusIs(kInvalid, "can't be read"));
  EXPECT_TRUE(ReadFeatureLines(std::nullopt)->lines.segments.empty());
}

TEST(SessionFile, HoldsANameAndWhetherThereAreAttributes) {
  const std::string path = ::testing::TempDir() + "session";
  const auto read = [&](const std::string& text) {
    std::ofstream(path, std::ios::binary) << text;
    return ReadSessionFile(path);
  };
  ASSERT_THAT(read("0a1b\n"), IsOk());
  EXPECT_EQ(read("0a1b\r\n")->name, "0a1b");
  EXPECT_FALSE(read("0a1b\n")->has_attributes);
  EXPECT_TRUE(read("0a1b attributes\n")->has_attributes);
  for (const std::string& text :
       {std::string(), std::string("a b"), std::string("\xff\xfe"), std::string("a attributes b")})
    EXPECT_THAT(read(text), StatusIs(kInvalid, "must be a file that --keep-session wrote")) << text;
  EXPECT_THAT(ReadSessionFile("/no/such/file"), StatusIs(kInvalid, "must be a file"));
}

TEST(SessionRevision, IsAWholeNumber) {
  EXPECT_EQ(*ParseSessionRevision(std::nullopt), std::nullopt);
  EXPECT_EQ(*ParseSessionRevision("0"), 0u);
  EXPECT_EQ(*ParseSessionRevision("18446744073709551615"), std::numeric_limits<uint64_t>::max());
  for (const char* text : {"", "-1", "1.5", "any", "18446744073709551616"})
    EXPECT_THAT(ParseSessionRevision(text), StatusIs(kInvalid, "must be a whole number")) << text;
}

TEST(MeshingFlags, SayNotYetInsteadOfIgnoring) {
  const std::vector<MeshingFlags> not_built = {{.seed_points = {"0,0,0"}},
                                               {.region = "sphere:0,0,0,1", .surface = "imls"}};
  for (const MeshingFlags& flags : not_built) EXPECT_THAT(Parse(flags), StatusIs(kInvalid, "not yet"));
}

TEST(CallFlags, ATimeoutIsPositiveSeconds) {
  EXPECT_TRUE(std::isinf(*ParseTimeout(std::nullopt)));
  EXPECT_EQ(*ParseTimeout("1.5"), 1.5);
  EXPECT_THAT(ParseTimeout("0"), StatusIs(kInvalid, "--timeout is 0"));
}

TEST(CallFlags, AServerHasAHostAndAPort) {
  EXPECT_THAT(CheckServerAddress("localhost:50051"), IsOk());
  EXPECT_THAT(CheckServerAddress("[::1]:1"), IsOk());
  for (const char* wrong : {"localhost", ":50051", "host:0", "host:65536", "host:x", ""}) {
    EXPECT_THAT(CheckServerAddress(wrong), StatusIs(kInvalid, "--server")) << wrong;
  }
}

TEST(CallFlags, AFormatComesFromTheFlagThenFromTheEnding) {
  EXPECT_EQ(*FormatFor("a.ply", "obj", "--in-format"), Format::kObj);
  EXPECT_EQ(*FormatFor("a.PLY.gz", std::nullopt, "--in-format"), Format::kPly);
  EXPECT_THAT(FormatFor("-", std::nullopt, "--in-format"), StatusIs(kInvalid, "--in-format"));
  EXPECT_THAT(FormatFor("a.ply", "doc", "--in-format"), StatusIs(kInvalid, "--in-format is doc"));
}

}  // namespace
}  // namespace meshfront
