#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "absl/strings/escaping.h"
#include "proto/wire/convert.h"
#include "proto/wire/crc32c.h"
#include "proto/wire/errors.h"
#include "proto/wire/sha256.h"

namespace meshfront {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

TEST(Crc32c, GivesTheCheckValueOfTheStandard) {
  EXPECT_EQ(Crc32c("123456789"), 0xe3069283u);
  EXPECT_EQ(PortableCrc32c("123456789"), 0xe3069283u);
  EXPECT_EQ(Crc32c(""), 0u);
}

TEST(Crc32c, IsTheSameInOnePieceAndInTwoAndWithoutTheInstruction) {
  std::string data;
  for (int i = 0; i < 1000; ++i) data.push_back(static_cast<char>(i * 7 + i / 256));
  for (const size_t cut : {0, 1, 7, 8, 9, 500, 1000}) {
    const absl::string_view all = data;
    EXPECT_EQ(Crc32c(all.substr(cut), Crc32c(all.substr(0, cut))), Crc32c(all)) << cut;
    EXPECT_EQ(PortableCrc32c(all.substr(cut)), Crc32c(all.substr(cut))) << cut;
  }
}

TEST(Crc32c, RunsOverTheFieldsOfAChunkInFieldOrder) {
  v1::Chunk chunk;
  chunk.set_finalised("9");
  chunk.set_indices("678");
  chunk.set_normals("5");
  chunk.set_positions("1234");
  EXPECT_EQ(ChunkCrc32c(chunk), 0xe3069283u);
}

TEST(Sha256, GivesTheDigestOfTheStandardInPieces) {
  Sha256 hash;
  hash.Update("a");
  hash.Update("bc");
  EXPECT_EQ(absl::BytesToHexString(hash.Finish()), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
}

TEST(OptionsFromProto, TakesCoresDefaultsForWhatIsNotSet) {
  const absl::StatusOr<RemeshOptions> options = OptionsFromProto(v1::RemeshOptions());
  ASSERT_TRUE(options.ok()) << options.status();
  EXPECT_EQ(options->rho, RemeshOptions().rho);
  EXPECT_EQ(options->eta, RemeshOptions().eta);
  EXPECT_TRUE(options->flips && options->smooth && options->fit && options->repair);
}

TEST(OptionsFromProto, KeepsAnExplicitFalseApartFromUnset) {
  v1::RemeshOptions proto;
  proto.set_flips(false);
  proto.set_repair(false);
  const absl::StatusOr<RemeshOptions> options = OptionsFromProto(proto);
  ASSERT_TRUE(options.ok()) << options.status();
  EXPECT_FALSE(options->flips);
  EXPECT_FALSE(options->repair);
  EXPECT_TRUE(options->smooth);
}

TEST(OptionsFromProto, KeepsCreasesFromFortyDegreesOnUnlessToldOtherwise) {
  v1::RemeshOptions proto;
  EXPECT_EQ(OptionsFromProto(proto)->crease_angle, 40);
  proto.mutable_crease()->set_angle_degrees(25);
  EXPECT_EQ(OptionsFromProto(proto)->crease_angle, 25);
  EXPECT_EQ(OptionsToProto(*OptionsFromProto(proto)).crease().angle_degrees(), 25);
  proto.mutable_crease()->set_off(true);
  EXPECT_EQ(OptionsFromProto(proto)->crease_angle, std::nullopt);
  EXPECT_TRUE(OptionsToProto(*OptionsFromProto(proto)).crease().off());
  proto.mutable_crease()->set_angle_degrees(180);
  EXPECT_THAT(std::string(OptionsFromProto(proto).status().message()),
              HasSubstr("options.crease.angle_degrees is 180; it must be in (0, 180)"));
}

TEST(OptionsFromProto, CarriesTheSurfaceOfAPointSetBothWays) {
  v1::RemeshOptions proto;
  proto.set_surface(v1::SURFACE_TYPE_IMLS), proto.set_mls_radius(3);
  const auto options = OptionsFromProto(proto);
  ASSERT_TRUE(options.ok()) << options.status();
  EXPECT_EQ(options->surface, SurfaceKind::kImls);
  EXPECT_EQ(OptionsToProto(*options).surface(), v1::SURFACE_TYPE_IMLS);
  EXPECT_EQ(OptionsToProto(*options).mls_radius(), 3);
  proto.set_surface(v1::SURFACE_TYPE_MLS);
  EXPECT_EQ(OptionsFromProto(proto)->surface, SurfaceKind::kMls);
  EXPECT_EQ(OptionsToProto(*OptionsFromProto(proto)).surface(), v1::SURFACE_TYPE_MLS);
  proto.set_mls_radius(17);
  EXPECT_EQ(OptionsFromProto(proto).status().code(), absl::StatusCode::kInvalidArgument);
}

TEST(OptionsFromProto, CarriesTheSizeOfGapsBothWays) {
  v1::RemeshOptions proto;
  EXPECT_EQ(OptionsFromProto(proto)->fill_gaps, std::nullopt);
  EXPECT_FALSE(OptionsToProto(RemeshOptions()).has_fill_gaps());
  proto.mutable_fill_gaps()->set_diagonal_fraction(0.25);
  EXPECT_EQ(OptionsToProto(*OptionsFromProto(proto)).fill_gaps().diagonal_fraction(), 0.25);
  proto.mutable_region()->mutable_sphere()->set_radius(1);
  EXPECT_THAT(std::string(RegionFromProto(proto).status().message()), HasSubstr("options.fill_gaps"));
  proto.mutable_fill_gaps()->set_absolute(-1);
  EXPECT_THAT(std::string(OptionsFromProto(proto).status().message()), HasSubstr("options.fill_gaps is -1"));
}

TEST(OptionsFromProto, RefusesWhatIsNotBuiltYetByItsPath) {
  std::vector<v1::RemeshOptions> cases(1);
  cases[0].mutable_region()->mutable_box(), cases[0].set_surface(v1::SURFACE_TYPE_MLS);
  for (const v1::RemeshOptions& proto : cases) {
    const absl::Status status = OptionsFromProto(proto).status();
    EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument) << proto.DebugString();
    EXPECT_THAT(std::string(status.message()), StartsWith("options."));
    EXPECT_THAT(std::string(status.message()), HasSubstr("not supported yet"));
  }
}

TEST(OptionsFromProto, CarriesLevelsOfDetailBothWays) {
  v1::RemeshOptions proto;
  proto.add_lod_rhos(0.3), proto.add_lod_rhos(1.5);
  const absl::StatusOr<RemeshOptions> options = OptionsFromProto(proto);
  ASSERT_TRUE(options.ok());
  EXPECT_EQ(options->lod_rhos, (std::vector<double>{0.3, 1.5}));
  const absl::StatusOr<RemeshOptions> again = OptionsFromProto(OptionsToProto(*options));
  ASSERT_TRUE(again.ok());
  EXPECT_EQ(again->lod_rhos, options->lod_rhos);
  proto.mutable_region()->set_face_count(1);
  EXPECT_THAT(std::string(RegionFromProto(proto).status().message()),
              StartsWith("options.region is set beside options.lod_rhos"));
  proto.set_rho(1);
  EXPECT_THAT(std::string(OptionsFromProto(proto).status().message()),
              StartsWith("options.lod_rhos is set beside options.rho"));
}

TEST(RegionFromProto, TakesABallABoxOrACountOfFaces) {
  v1::RemeshOptions proto;
  EXPECT_FALSE(RegionFromProto(proto)->has_value());
  proto.mutable_region()->mutable_sphere()->set_radius(2);
  proto.mutable_region()->mutable_sphere()->mutable_center()->set_y(1);
  EXPECT_EQ(std::get<RegionSphere>((*RegionFromProto(proto))->shape).center, (Vec3{0, 1, 0}));
  proto.mutable_region()->mutable_box()->mutable_max()->set_x(3);
  proto.mutable_region()->set_patch_only(true);
  EXPECT_EQ(std::get<Box3>((*RegionFromProto(proto))->shape).max, (Vec3{3, 0, 0}));
  EXPECT_TRUE((*RegionFromProto(proto))->patch_only);
  proto.mutable_region()->set_face_count(5);
  EXPECT_TRUE(std::get<RegionFaces>((*RegionFromProto(proto))->shape).empty()) << "their array comes later";
}

TEST(RegionFromProto, NamesTheFieldOfWhatIsWrong) {
  std::vector<v1::RemeshOptions> cases(5);
  cases[0].mutable_region();
  cases[1].mutable_region()->mutable_sphere()->set_radius(-1);
  cases[2].mutable_region()->mutable_sphere()->mutable_center()->set_x(NAN);
  cases[3].mutable_region()->mutable_box()->mutable_min()->set_x(1);
  cases[4].mutable_region()->set_face_count(0);
  const char* const paths[] = {"options.region is empty", "options.region.sphere.radius is -1",
                               "options.region.sphere.center is not finite", "options.region.box.min is ",
                               "options.region.face_count is 0"};
  for (size_t i = 0; i < cases.size(); ++i) {
    const absl::Status status = RegionFromProto(cases[i]).status();
    EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument);
    EXPECT_THAT(std::string(status.message()), StartsWith(paths[i]));
  }
}

TEST(OptionsFromProto, TakesTheWidthOfTheBlend) {
  v1::RemeshOptions proto;
  proto.set_blend(4);
  EXPECT_EQ(OptionsFromProto(proto)->blend, 4);
  EXPECT_EQ(OptionsToProto(*OptionsFromProto(proto)).blend(), 4);
  proto.set_blend(1001);
  EXPECT_THAT(std::string(OptionsFromProto(proto).status().message()), StartsWith("options.blend is 1001"));
}

TEST(OptionsFromProto, RefusesContradictionsAndValuesOutOfRange) {
  std::vector<v1::RemeshOptions> cases(12);
  cases[0].set_rho(0.5), cases[0].mutable_edge_length()->set_absolute(1);
  cases[1].set_sizing(v1::SIZING_UNIFORM);
  cases[2].set_sizing(v1::SIZING_ANGLE), cases[2].mutable_edge_length()->set_absolute(1);
  cases[3].mutable_edge_length();
  cases[4].mutable_min_edge()->set_absolute(-1);
  cases[5].set_eta(2.5);
  cases[6].set_rho(0.5), cases[6].set_sizing(v1::SIZING_ERROR);
  cases[7].set_rho(0.5), cases[7].set_target_triangles(1000);
  cases[8].mutable_max_error()->set_absolute(1), cases[8].set_sizing(v1::SIZING_UNIFORM);
  cases[9].mutable_max_error()->set_absolute(1), cases[9].mutable_edge_length()->set_absolute(1);
  cases[10].set_target_triangles(3);
  cases[11].mutable_max_error()->set_diagonal_fraction(0);
  for (const v1::RemeshOptions& proto : cases) {
    const absl::Status status = OptionsFromProto(proto).status();
    EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument) << proto.DebugString();
    EXPECT_THAT(std::string(status.message()), StartsWith("options."));
  }
}

TEST(OptionsFromProto, TakesTheSizingThatTheParameterImplies) {
  v1::RemeshOptions proto;
  proto.mutable_max_error()->set_diagonal_fraction(0.002);
  const absl::StatusOr<RemeshOptions> error = OptionsFromProto(proto);
  ASSERT_TRUE(error.ok()) << error.status();
  EXPECT_EQ(error->sizing, Sizing::kError);
  EXPECT_EQ(error->max_error->value, 0.002);
  EXPECT_TRUE(error->max_error->relative);
  proto.clear_max_error();
  proto.set_target_triangles(500);
  EXPECT_EQ(OptionsFromProto(proto)->sizing, Sizing::kAngle);
  EXPECT_EQ(OptionsFromProto(proto)->target_triangles, 500u);
  proto.set_sizing(v1::SIZING_UNIFORM);
  EXPECT_EQ(OptionsFromProto(proto)->sizing, Sizing::kUniform);
}

TEST(OptionsFromProto, TakesAnAngleForTheThicknessToo) {
  v1::RemeshOptions proto;
  proto.set_sizing(v1::SIZING_THICKNESS);
  proto.set_rho(0.4);
  const absl::StatusOr<RemeshOptions> options = OptionsFromProto(proto);
  ASSERT_TRUE(options.ok()) << options.status();
  EXPECT_EQ(options->sizing, Sizing::kThickness);
  EXPECT_EQ(options->rho, 0.4);
  EXPECT_EQ(OptionsToProto(*options).sizing(), v1::SIZING_THICKNESS);
  EXPECT_EQ(OptionsToProto(*options).rho(), 0.4);
  proto.clear_rho();
  proto.mutable_max_error()->set_diagonal_fraction(0.002);
  EXPECT_FALSE(OptionsFromProto(proto).ok());
}

TEST(OptionsFromProto, ReadsBackASizingByErrorAndATarget) {
  RemeshOptions options;
  options.sizing = Sizing::kError;
  options.max_error = Length{0.25, false};
  absl::StatusOr<RemeshOptions> back = OptionsFromProto(OptionsToProto(options));
  ASSERT_TRUE(back.ok()) << back.status();
  EXPECT_EQ(back->sizing, Sizing::kError);
  EXPECT_EQ(back->max_error->value, 0.25);
  options.max_error.reset();
  options.target_triangles = 777;
  back = OptionsFromProto(OptionsToProto(options));
  ASSERT_TRUE(back.ok()) << back.status();
  EXPECT_EQ(back->target_triangles, 777u);
}

TEST(OptionsFromProto, ReadsBackWhatOptionsToProtoWrote) {
  RemeshOptions options;
  options.eta = 1.5;
  options.sizing = Sizing::kUniform;
  options.edge_length = Length{0.01, true};
  options.max_edge = Length{3, false};
  options.smooth = false;
  const absl::StatusOr<RemeshOptions> back = OptionsFromProto(OptionsToProto(options));
  ASSERT_TRUE(back.ok()) << back.status();
  EXPECT_EQ(back->eta, 1.5);
  EXPECT_EQ(back->sizing, Sizing::kUniform);
  EXPECT_TRUE(back->edge_length->relative);
  EXPECT_EQ(back->edge_length->value, 0.01);
  EXPECT_EQ(back->max_edge->value, 3);
  EXPECT_FALSE(back->smooth);
}

TEST(SummaryFromReport, LosesNothingOnTheWayThereAndBack) {
  Report report;
  report.input.topology.genus = -1;
  report.input.repairs = {{"dropped_degenerate_faces", 30}};
  report.output.triangles = 12;
  report.complete = false;
  report.open_places = {{1, 2, 3}};
  report.quality.min_angle_deg = 31;
  report.triangles_by_kind.closing = 4;
  report.refusals = {{"fence", 7}};
  report.seconds.guidance = 0.5;
  report.peak_front_edges = 99;
  const Report back = ReportFromSummary(SummaryFromReport(report));
  EXPECT_EQ(SummaryFromReport(back).SerializeAsString(), SummaryFromReport(report).SerializeAsString());
  EXPECT_EQ(back.input.topology.genus, -1);
  EXPECT_FALSE(back.output.genus.has_value());
  EXPECT_EQ(back.input.repairs[0].count, 30u);
  EXPECT_EQ(back.open_places[0].z, 3);
}

TEST(SummaryFromReport, ListsABoundedNumberOfPlacesAndCountsAll) {
  Report report;
  report.open_places.resize(5000);
  const v1::Summary summary = SummaryFromReport(report);
  EXPECT_EQ(summary.open_places_size(), kMaxListedOpenPlaces);
  EXPECT_EQ(summary.open_place_count(), 5000u);
}

TEST(NormalizeOutput, FillsDefaultsAndRefusesSizesOutOfRange) {
  EXPECT_EQ(NormalizeOutput(v1::OutputFormat())->chunk_bytes(), kDefaultChunkBytes);
  EXPECT_EQ(NormalizeOutput(v1::OutputFormat())->scalar_type(), v1::SCALAR_TYPE_FLOAT32);
  for (const uint32_t bytes : {0u, kMinChunkBytes - 1, kMaxChunkBytes + 1}) {
    v1::OutputFormat output;
    output.set_chunk_bytes(bytes);
    EXPECT_EQ(FieldPathOf(NormalizeOutput(output).status().message()), "output.chunk_bytes");
  }
}

TEST(FieldPathOf, FindsThePathThatAMessageBeginsWith) {
  EXPECT_EQ(FieldPathOf("options.eta is 2.5; it must be in (1, 2)"), "options.eta");
  EXPECT_EQ(FieldPathOf("options.crease.angle_degrees is not supported yet"), "options.crease.angle_degrees");
  EXPECT_EQ(FieldPathOf("request_id has 200 bytes"), "request_id");
  EXPECT_EQ(FieldPathOf("block.data is empty"), "block.data");
}

TEST(FieldPathOf, FindsNoneInAnOrdinarySentence) {
  EXPECT_EQ(FieldPathOf("mesh has no face with area"), "");
  EXPECT_EQ(FieldPathOf("bunny.off: line 7: not a number"), "");
  EXPECT_EQ(FieldPathOf(""), "");
}

TEST(ToGrpcStatus, MapsEveryCodeToTheOneOfTheSameNumber) {
  for (int code = 1; code <= 16; ++code) {
    const absl::Status status(static_cast<absl::StatusCode>(code), "why");
    EXPECT_EQ(static_cast<int>(ToGrpcStatus(status).error_code()), code);
    EXPECT_EQ(FromGrpcStatus(ToGrpcStatus(status)).code(), status.code());
  }
  EXPECT_TRUE(ToGrpcStatus(absl::OkStatus()).ok());
}

TEST(ToGrpcStatus, NamesTheFieldOfABadOption) {
  const google::rpc::Status details =
      DetailsOf(ToGrpcStatus(absl::InvalidArgumentError("options.eta is 3; it must be in (1, 2)")));
  google::rpc::BadRequest bad;
  bool found = false;
  for (const google::protobuf::Any& any : details.details()) found |= any.UnpackTo(&bad);
  ASSERT_TRUE(found);
  EXPECT_EQ(bad.field_violations(0).field(), "options.eta");
}

TEST(ToGrpcStatus, CarriesReasonMetadataAndRetry) {
  const absl::Status status = WithRetry(
      WithReason(absl::ResourceExhaustedError("full"), "QUEUE_FULL", {{"queued", "7"}}), absl::Milliseconds(1250));
  const grpc::Status wire = ToGrpcStatus(status);
  const ErrorReason reason = ReasonOf(FromGrpcStatus(wire));
  EXPECT_EQ(reason.reason, "QUEUE_FULL");
  EXPECT_EQ(reason.metadata.at("queued"), "7");
  google::rpc::RetryInfo retry;
  bool found = false;
  const google::rpc::Status details = DetailsOf(wire);
  for (const google::protobuf::Any& any : details.details()) found |= any.UnpackTo(&retry);
  ASSERT_TRUE(found);
  EXPECT_EQ(retry.retry_delay().seconds(), 1);
  EXPECT_EQ(retry.retry_delay().nanos(), 250'000'000);
}

TEST(ToGrpcStatus, TellsToRetryWheneverItIsUnavailable) {
  const google::rpc::Status details = DetailsOf(ToGrpcStatus(absl::UnavailableError("draining")));
  google::rpc::RetryInfo retry;
  bool found = false;
  for (const google::protobuf::Any& any : details.details()) found |= any.UnpackTo(&retry);
  EXPECT_TRUE(found);
}

TEST(ToGrpcStatus, StaysBelowEightKibibytesWhateverItIsGiven) {
  std::string huge;
  for (int i = 0; i < 20000; ++i) huge += "π";
  ErrorMetadata metadata;
  for (int i = 0; i < 100; ++i) metadata.emplace_back("key" + std::to_string(i), huge);
  const grpc::Status wire =
      ToGrpcStatus(WithReason(absl::InvalidArgumentError("options.eta " + huge), "BAD", metadata));
  // A byte that is not ASCII takes three in the message's trailer; the details are in base64.
  EXPECT_LT(3 * wire.error_message().size() + wire.error_details().size() * 4 / 3, 8192u);
  EXPECT_EQ(wire.error_message().size() % 2, 0u) << "cut inside a character";
  EXPECT_FALSE(DetailsOf(wire).details().empty());
}

TEST(DetailsOf, AreEmptyWhenDamaged) {
  EXPECT_TRUE(DetailsOf(grpc::Status(grpc::StatusCode::INTERNAL, "x", "\xff\xff not a message")).details().empty());
}

TEST(DefectToProto, LeavesOutAPlaceThatIsNotFinite) {
  Defect defect{"non_finite_vertex", "vertex 1 of triangle 0", {FaceId(0)}, {VertexId(1)}, std::nullopt};
  EXPECT_FALSE(DefectToProto(defect).has_position());
  defect.position = Vec3{1, 2, 3};
  EXPECT_EQ(DefectToProto(defect).position().z(), 3);
}

}  // namespace
}  // namespace meshfront
