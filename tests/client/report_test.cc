// What the program tells: the progress line, the stats, the figures, the sample, exit codes.
#include <optional>
#include <sstream>

#include "client/cli/exit_code.h"
#include "client/cli/figures.h"
#include "client/cli/process.h"
#include "client/cli/progress_bar.h"
#include "client/cli/sample_mesh.h"
#include "client/cli/stats.h"
#include "client/cli/text.h"
#include "core/geometry/triangle.h"
#include "proto/wire/convert.h"
#include "proto/wire/errors.h"
#include "tests/support/matchers.h"

namespace meshfront {
namespace {

using Json = nlohmann::ordered_json;

TEST(Sample, IsClosedManifoldAndFullOfSlivers) {
  const TriangleMesh mesh = SampleMesh();
  EXPECT_THAT(mesh, testing::IsClosedManifold());
  EXPECT_THAT(mesh, testing::HasComponents(1));
  EXPECT_THAT(mesh, testing::HasGenus(6));
  EXPECT_GE(mesh.triangles.size(), 20000u);
  EXPECT_LE(mesh.triangles.size(), 40000u);
  size_t slivers = 0;
  double volume = 0;
  for (const Triangle& t : mesh.triangles) {
    const Vec3 &a = mesh.PositionAt(t[0]), &b = mesh.PositionAt(t[1]), &c = mesh.PositionAt(t[2]);
    slivers += RadiusRatio(a, b, c) < 0.3;
    volume += Dot(a, Cross(b, c)) / 6;
  }
  EXPECT_GT(slivers, mesh.triangles.size() / 10);
  EXPECT_GT(volume, 0) << "inside out";
}

TEST(Sample, IsTheSameOnEveryCall) { EXPECT_EQ(SampleMesh().positions, SampleMesh().positions); }

TEST(ProgressLine, SaysTheStageWhileThereIsNothingToCount) {
  EXPECT_EQ(ProgressLine({"curvature", 0, 0}, 0), "curvature …");
}

TEST(ProgressLine, CountsRateAndRemainingTime) {
  const std::string line = ProgressLine({"mesh", 100000, 25000}, 0.5);
  EXPECT_NE(line.find("25%"), std::string::npos) << line;
  EXPECT_NE(line.find("25,000 of 100,000 triangles"), std::string::npos) << line;
  EXPECT_NE(line.find("50k/s"), std::string::npos) << line;
  EXPECT_NE(line.find("0:02 left"), std::string::npos) << line;
}

TEST(ProgressLine, IsNeverFullBeforeTheEnd) {
  const std::string line = ProgressLine({"mesh", 100, 150}, 10);
  EXPECT_NE(line.find("99%"), std::string::npos) << line;
  EXPECT_EQ(line.find("left"), std::string::npos) << line;
}

TEST(ProgressBar, IsSilentWhenDisabledAndWipesItselfOtherwise) {
  std::ostringstream silent, drawn;
  {
    ProgressBar bar(silent, false);
    bar.Update({"mesh", 10, 5});
  }
  {
    ProgressBar bar(drawn, true);
    bar.Update({"mesh", 10, 5});
  }
  EXPECT_EQ(silent.str(), "");
  EXPECT_NE(drawn.str().find("5 of 10"), std::string::npos);
  EXPECT_EQ(drawn.str().substr(drawn.str().size() - 4), "\r\x1b[K");
}

TEST(Text, GroupsThousands) {
  EXPECT_EQ(WithThousands(0), "0");
  EXPECT_EQ(WithThousands(999), "999");
  EXPECT_EQ(WithThousands(1000), "1,000");
  EXPECT_EQ(WithThousands(1234567), "1,234,567");
  EXPECT_EQ(WithByteUnit(1500), "1.5 KB");
}

v1::Summary SomeSummary() {
  Report report;
  report.input.topology.triangles = 7;
  report.input.topology.genus = 2;
  report.input.repairs = {{"dropped_degenerate_faces", 3}};
  report.predicted_triangles = 1000;
  report.output.triangles = 990;
  report.complete = false;
  report.open_places = {{1, 2, 3}};
  report.quality.radius_ratio_median = 0.98;
  return SummaryFromReport(report);
}

// Every key of the contract, as a path.
TEST(Stats, HoldEveryKeyOfTheContract) {
  const Json stats =
      StatsJson("1", SomeSummary(), {.read = 1, .total = 2, .peak_rss_bytes = 5, .chunks = 4, .remote = true});
  for (const char* path : {"/version",
                           "/command",
                           "/input/kind",
                           "/input/vertices",
                           "/input/triangles",
                           "/input/components",
                           "/input/boundary_loops",
                           "/input/genus",
                           "/input/repairs/0/what",
                           "/input/repairs/0/count",
                           "/parameters/rho",
                           "/parameters/eta",
                           "/predicted_triangles",
                           "/error_bound",
                           "/output/vertices",
                           "/output/triangles",
                           "/output/components",
                           "/output/boundary_loops",
                           "/output/genus",
                           "/output/closed",
                           "/output/manifold",
                           "/output/open_places/0/2",
                           "/quality/radius_ratio_min",
                           "/quality/radius_ratio_p0_5",
                           "/quality/radius_ratio_median",
                           "/quality/min_angle_deg",
                           "/triangles_by_kind/free",
                           "/triangles_by_kind/connection",
                           "/triangles_by_kind/closing",
                           "/flips",
                           "/seconds/read",
                           "/seconds/upload",
                           "/seconds/index",
                           "/seconds/curvature",
                           "/seconds/guidance",
                           "/seconds/features",
                           "/seconds/mesh",
                           "/seconds/first_chunk",
                           "/seconds/engine",
                           "/seconds/write",
                           "/seconds/total",
                           "/peak_rss_bytes",
                           "/peak_front_edges",
                           "/chunks",
                           "/threads",
                           "/server_peak_rss_bytes"}) {
    EXPECT_TRUE(stats.contains(Json::json_pointer(path))) << path;
  }
  EXPECT_EQ(stats["input"]["kind"], "mesh");
  EXPECT_EQ(stats["input"]["genus"], 2);
  EXPECT_TRUE(stats["output"]["genus"].is_null());
  EXPECT_EQ(stats["seconds"]["total"], 2);
}

TEST(Stats, NameTheRevisionOfASession) {
  v1::Summary summary = SomeSummary();
  EXPECT_FALSE(StatsJson("1", summary, {}).contains("session"));
  summary.mutable_session()->set_revision(7);
  const nlohmann::ordered_json stats = StatsJson("1", summary, {});
  EXPECT_EQ(stats["session"]["revision"], 7);
  EXPECT_THAT(FiguresTable(stats), ::testing::HasSubstr("revision 7"));
}

TEST(Stats, HoldNoServerMemoryWhenThereIsNoServer) {
  EXPECT_FALSE(StatsJson("1", SomeSummary(), {}).contains("server_peak_rss_bytes"));
}

TEST(Stats, HaveNoRhoWhereTheSizingIsUniform) {
  v1::Summary summary = SomeSummary();
  summary.mutable_parameters()->mutable_options()->set_sizing(v1::SIZING_UNIFORM);
  summary.mutable_parameters()->mutable_options()->clear_rho();
  EXPECT_TRUE(StatsJson("1", summary, {})["parameters"]["rho"].is_null());
}

TEST(Stats, SayWhichEdgesWereCreases) {
  const auto crease_angle_of = [](std::optional<double> degrees) {
    Report report;
    report.parameters.options.crease_angle = degrees;
    return StatsJson("1", SummaryFromReport(report), {})["parameters"]["crease_angle"];
  };
  EXPECT_EQ(crease_angle_of(40), 40);
  EXPECT_EQ(crease_angle_of(25.5), 25.5);
  EXPECT_EQ(crease_angle_of(std::nullopt), "off");
}

TEST(Estimate, HoldsEveryKeyOfTheContract) {
  const Json json = EstimateJson(EstimateToProto(Estimate{}));
  for (const char* path : {"/predicted_triangles", "/error_bound", "/edge_length/min", "/edge_length/median",
                           "/edge_length/max", "/memory_bytes", "/input/kind", "/parameters/rho"}) {
    EXPECT_TRUE(json.contains(Json::json_pointer(path))) << path;
  }
}

TEST(Figures, ShowTheCountsAndSurviveAnything) {
  const std::string table = FiguresTable(StatsJson("1", SomeSummary(), {}));
  EXPECT_NE(table.find("990 triangles"), std::string::npos) << table;
  EXPECT_FALSE(FiguresTable(Json::object()).empty());
  EXPECT_FALSE(FiguresTable(Json::parse(R"({"input": 3, "seconds": {"mesh": "x"}})")).empty());
}

TEST(ExitCodes, FollowTheContract) {
  EXPECT_EQ(ExitCodeOfCall(absl::InvalidArgumentError("options.eta is 3; it must be in (1, 2)")), ExitCode::kUsage);
  EXPECT_EQ(ExitCodeOfCall(absl::InvalidArgumentError("no finite face with area is left")), ExitCode::kInput);
  EXPECT_EQ(ExitCodeOfCall(absl::FailedPreconditionError("an edge has three faces")), ExitCode::kInput);
  EXPECT_EQ(ExitCodeOfCall(absl::UnavailableError("x")), ExitCode::kServer);
  EXPECT_EQ(ExitCodeOfCall(absl::ResourceExhaustedError("x")), ExitCode::kServer);
  EXPECT_EQ(ExitCodeOfCall(absl::UnauthenticatedError("x")), ExitCode::kServer);
  EXPECT_EQ(ExitCodeOfCall(absl::DataLossError("x")), ExitCode::kServer);
  EXPECT_EQ(ExitCodeOfCall(absl::CancelledError("x")), ExitCode::kCancelled);
  EXPECT_EQ(ExitCodeOfCall(absl::DeadlineExceededError("x")), ExitCode::kCancelled);
  EXPECT_EQ(ExitCodeOfCall(absl::InternalError("x")), ExitCode::kInternalError);
  EXPECT_EQ(ExitCodeOfCall(FromGrpcStatus(ToGrpcStatus(absl::InvalidArgumentError("options.rho is 9; x")))),
            ExitCode::kUsage);
}

TEST(Process, KnowsItsAgeAndMemory) {
  const double age = SecondsSinceProcessStart();
  EXPECT_GT(age, 0);
  EXPECT_GE(SecondsSinceProcessStart(), age);
  EXPECT_GT(PeakRssBytes(), 1u << 20);
}

}  // namespace
}  // namespace meshfront
