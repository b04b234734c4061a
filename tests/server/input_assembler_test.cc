#include "server/input_assembler.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "proto/wire/convert.h"
#include "proto/wire/errors.h"
#include "tests/server/fakes.h"

namespace meshfront {
namespace {

using ::testing::HasSubstr;
using Code = absl::StatusCode;

const std::string kPositions = Bytes<double>({0, 0, 0, 1, 0, 0, 0, 1, 0});
const std::string kTriangle = Bytes<uint32_t>({0, 1, 2});

// An assembler that has seen the header of one triangle.
struct Started {
  explicit Started(v1::Header header = TriangleHeader(), ServerLimits limits = {}) : assembler(limits) {
    EXPECT_TRUE(assembler.Accept(header).ok());
  }
  InputAssembler assembler;
};

TEST(InputAssembler, PutsAMeshTogetherFromBlocksOfAnySize) {
  for (size_t block = 1; block <= kPositions.size(); ++block) {
    Started s;
    for (size_t at = 0; at < kPositions.size(); at += block) {
      ASSERT_TRUE(s.assembler.Accept(Block(v1::ARRAY_POSITIONS, at, kPositions.substr(at, block))).ok());
    }
    for (size_t at = 0; at < kTriangle.size(); at += block) {
      ASSERT_TRUE(s.assembler.Accept(Block(v1::ARRAY_TRIANGLES, at, kTriangle.substr(at, block))).ok());
    }
    ASSERT_TRUE(s.assembler.Accept(v1::EndOfInput()).ok());
    ASSERT_TRUE(s.assembler.whole());
    const AssembledInput input = s.assembler.Take();
    EXPECT_EQ(input.mesh.positions, (std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}));
    EXPECT_EQ(input.mesh.triangles, (std::vector<Triangle>{{VertexId(0), VertexId(1), VertexId(2)}}));
  }
}

TEST(InputAssembler, WidensFloatsThatStraddleBlocks) {
  v1::Header header = TriangleHeader();
  header.mutable_mesh()->set_scalar_type(v1::SCALAR_TYPE_FLOAT32);
  const std::string floats = Bytes<float>({0, 0.5f, 0, 1, 0, 0, 0, 1, -2});
  for (const size_t block : {1, 2, 3, 5, 7, 11, 36}) {
    Started s(header);
    for (size_t at = 0; at < floats.size(); at += block) {
      ASSERT_TRUE(s.assembler.Accept(Block(v1::ARRAY_POSITIONS, at, floats.substr(at, block))).ok());
    }
    ASSERT_TRUE(s.assembler.Accept(Block(v1::ARRAY_TRIANGLES, 0, kTriangle)).ok());
    ASSERT_TRUE(s.assembler.Accept(v1::EndOfInput()).ok());
    EXPECT_EQ(s.assembler.Take().mesh.positions, (std::vector<Vec3>{{0, 0.5, 0}, {1, 0, 0}, {0, 1, -2}})) << block;
  }
}

TEST(InputAssembler, ScalesTheNormalsOfPointsToUnitLength) {
  v1::Header header;
  header.mutable_points()->set_point_count(1);
  header.mutable_points()->set_has_normals(true);
  Started s(header);
  ASSERT_TRUE(s.assembler.Accept(Block(v1::ARRAY_NORMALS, 0, Bytes<double>({0, 0, 5}))).ok());
  ASSERT_TRUE(s.assembler.Accept(Block(v1::ARRAY_POSITIONS, 0, Bytes<double>({1, 2, 3}))).ok());
  ASSERT_TRUE(s.assembler.Accept(v1::EndOfInput()).ok());
  EXPECT_EQ(s.assembler.Take().mesh.normals, (std::vector<Vec3>{{0, 0, 1}}));
}

TEST(InputAssembler, KeepsTheBytesOfAFileAndTakesItsFormatFromTheName) {
  v1::Header header;
  header.mutable_file()->set_size_bytes(5);
  header.mutable_file()->set_name("a/b.PLY");
  Started s(header);
  ASSERT_TRUE(s.assembler.Accept(Block(v1::ARRAY_FILE, 0, "hello")).ok());
  ASSERT_TRUE(s.assembler.Accept(v1::EndOfInput()).ok());
  const AssembledInput input = s.assembler.Take();
  EXPECT_EQ(std::string(input.file.begin(), input.file.end()), "hello");
  EXPECT_EQ(input.format, Format::kPly);
}

TEST(InputAssembler, PutsTheFacesOfARegionBesideTheMesh) {
  v1::Header header = TriangleHeader();
  header.mutable_options()->mutable_region()->set_face_count(2);
  Started s(header);
  const std::string faces = Bytes<uint32_t>({0, 7});
  ASSERT_TRUE(s.assembler.Accept(Block(v1::ARRAY_POSITIONS, 0, kPositions)).ok());
  ASSERT_TRUE(s.assembler.Accept(Block(v1::ARRAY_TRIANGLES, 0, kTriangle)).ok());
  EXPECT_THAT(std::string(s.assembler.Accept(v1::EndOfInput()).message()),
              HasSubstr("end came when ARRAY_REGION_FACES had 0 of 8 bytes"));
  ASSERT_TRUE(s.assembler.Accept(Block(v1::ARRAY_REGION_FACES, 0, faces.substr(0, 3))).ok());
  ASSERT_TRUE(s.assembler.Accept(Block(v1::ARRAY_REGION_FACES, 3, faces.substr(3))).ok());
  ASSERT_TRUE(s.assembler.Accept(v1::EndOfInput()).ok());
  EXPECT_EQ(std::get<RegionFaces>(s.assembler.Take().region->shape), (RegionFaces{0, 7}));
}

TEST(InputAssembler, PutsLinesBesideTheMesh) {
  v1::Header header = TriangleHeader();
  v1::FeatureCurves* curves = header.mutable_options()->mutable_features();
  curves->set_point_count(2), curves->set_segment_count(1);
  for (const uint32_t last : {1u, 2u}) {
    Started s(header);
    ASSERT_TRUE(s.assembler.Accept(Block(v1::ARRAY_POSITIONS, 0, kPositions)).ok());
    ASSERT_TRUE(s.assembler.Accept(Block(v1::ARRAY_TRIANGLES, 0, kTriangle)).ok());
    EXPECT_THAT(std::string(s.assembler.Accept(v1::EndOfInput()).message()), HasSubstr("ARRAY_FEATURE_POSITIONS"));
    ASSERT_TRUE(s.assembler.Accept(Block(v1::ARRAY_FEATURE_POSITIONS, 0, Bytes<double>({0, 0, 0, 0.5, 0.5, 0}))).ok());
    ASSERT_TRUE(s.assembler.Accept(Block(v1::ARRAY_FEATURE_SEGMENTS, 0, Bytes<uint32_t>({0, last}))).ok());
    const absl::Status end = s.assembler.Accept(v1::EndOfInput());
    if (last == 2) {
      EXPECT_THAT(std::string(end.message()), HasSubstr("options.features.segments[0] names point 2"));
      continue;
    }
    ASSERT_TRUE(end.ok()) << end;
    const Polylines lines = s.assembler.Take().features;
    EXPECT_EQ(lines.points, (std::vector<Vec3>{{0, 0, 0}, {0.5, 0.5, 0}}));
    EXPECT_EQ(lines.segments, (std::vector<std::array<uint32_t, 2>>{{0, 1}}));
  }
  curves->set_segment_count(0);
  EXPECT_EQ(InputAssembler({}).Accept(header).code(), Code::kInvalidArgument);
  v1::Header points;
  points.mutable_points()->set_point_count(3);
  curves->set_segment_count(1);
  *points.mutable_options() = header.options();
  points.mutable_points()->set_scalar_type(v1::SCALAR_TYPE_FLOAT32);  // lines have the points' scalars
  Started s(points);
  ASSERT_TRUE(s.assembler.Accept(Block(v1::ARRAY_POSITIONS, 0, Bytes<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}))).ok());
  ASSERT_TRUE(s.assembler.Accept(Block(v1::ARRAY_FEATURE_POSITIONS, 0, Bytes<float>({0, 0, 0, 0.5, 0.5, 0}))).ok());
  ASSERT_TRUE(s.assembler.Accept(Block(v1::ARRAY_FEATURE_SEGMENTS, 0, Bytes<uint32_t>({0, 1}))).ok());
  ASSERT_TRUE(s.assembler.Accept(v1::EndOfInput()).ok());
  EXPECT_EQ(s.assembler.Take().features.points.back(), (Vec3{0.5, 0.5, 0}));
}

TEST(InputAssembler, RefusesAHeaderThatSaysNothingOrTooMuch) {
  struct Case {
    std::function<void(v1::Header&)> change;
    Code code;
    std::string message;
  };
  const std::vector<Case> cases = {
      {[](v1::Header& h) { h.clear_mesh(); }, Code::kInvalidArgument, "header.input"},
      {[](v1::Header& h) { h.mutable_mesh()->set_vertex_count(0); }, Code::kInvalidArgument, "mesh.vertex_count"},
      {[](v1::Header& h) { h.mutable_mesh()->set_triangle_count(0); }, Code::kInvalidArgument, "mesh.triangle_count"},
      {[](v1::Header& h) { h.mutable_mesh()->set_vertex_count(~0ull); }, Code::kResourceExhausted, "mesh.vertex_count"},
      {[](v1::Header& h) { h.mutable_mesh()->set_triangle_count(~0ull / 12); }, Code::kResourceExhausted,
       "mesh.triangle_count"},
      {[](v1::Header& h) { h.mutable_mesh()->set_vertex_count(190'000'000); }, Code::kResourceExhausted,
       "header.input"},
      {[](v1::Header& h) { h.mutable_file()->set_size_bytes(1ull << 40); }, Code::kResourceExhausted,
       "file.size_bytes"},
      {[](v1::Header& h) { h.mutable_file()->set_size_bytes(9); }, Code::kInvalidArgument, "file.format"},
      {[](v1::Header& h) { h.set_request_id("a\nb"); }, Code::kInvalidArgument, "request_id"},
      {[](v1::Header& h) { h.set_request_id(std::string(129, 'a')); }, Code::kInvalidArgument, "request_id"},
      {[](v1::Header& h) { h.mutable_output()->set_chunk_bytes(1); }, Code::kInvalidArgument, "output.chunk_bytes"},
      {[](v1::Header& h) { h.mutable_mesh()->set_scalar_type(static_cast<v1::ScalarType>(9)); }, Code::kInvalidArgument,
       "mesh.scalar_type"},
      {[](v1::Header& h) { h.mutable_options()->set_eta(9); }, Code::kInvalidArgument, "options.eta"},
  };
  for (const Case& c : cases) {
    v1::Header header = TriangleHeader();
    c.change(header);
    InputAssembler assembler{ServerLimits()};
    const absl::Status status = assembler.Accept(header);
    EXPECT_EQ(status.code(), c.code) << c.message;
    EXPECT_THAT(std::string(status.message()), HasSubstr(c.message));
  }
}

TEST(InputAssembler, RefusesMessagesInTheWrongOrder) {
  InputAssembler fresh{ServerLimits()};
  EXPECT_EQ(fresh.Accept(Block(v1::ARRAY_POSITIONS, 0, kPositions)).code(), Code::kInvalidArgument);
  EXPECT_EQ(fresh.Accept(v1::EndOfInput()).code(), Code::kInvalidArgument);
  EXPECT_EQ(fresh.AcceptMessage(v1::RemeshRequest()).code(), Code::kInvalidArgument);
  Started s;
  EXPECT_EQ(s.assembler.Accept(TriangleHeader()).code(), Code::kInvalidArgument);
}

TEST(InputAssembler, RefusesBlocksThatLeaveAGapOverlapOrGoBeyond) {
  Started s;
  ASSERT_TRUE(s.assembler.Accept(Block(v1::ARRAY_POSITIONS, 0, kPositions.substr(0, 24))).ok());
  EXPECT_EQ(s.assembler.Accept(Block(v1::ARRAY_POSITIONS, 25, "x")).code(), Code::kInvalidArgument);
  EXPECT_EQ(s.assembler.Accept(Block(v1::ARRAY_POSITIONS, 0, "x")).code(), Code::kInvalidArgument);
  EXPECT_EQ(s.assembler.Accept(Block(v1::ARRAY_POSITIONS, 24, "")).code(), Code::kInvalidArgument);
  EXPECT_EQ(s.assembler.Accept(Block(v1::ARRAY_POSITIONS, 24, std::string(49, 'x'))).code(), Code::kInvalidArgument);
  EXPECT_EQ(s.assembler.Accept(Block(v1::ARRAY_NORMALS, 0, "x")).code(), Code::kInvalidArgument);
  EXPECT_EQ(s.assembler.Accept(Block(v1::ARRAY_FILE, 0, "x")).code(), Code::kInvalidArgument);
}

TEST(InputAssembler, RefusesABlockBeyondOneMebibyte) {
  v1::Header header = TriangleHeader();
  header.mutable_mesh()->set_vertex_count(1'000'000);
  Started s(header);
  EXPECT_TRUE(s.assembler.Accept(Block(v1::ARRAY_POSITIONS, 0, std::string(kMaxBlockBytes, 'x'))).ok());
  const absl::Status status =
      s.assembler.Accept(Block(v1::ARRAY_POSITIONS, kMaxBlockBytes, std::string(kMaxBlockBytes + 1, 'x')));
  EXPECT_EQ(FieldPathOf(status.message()), "block.data");
}

TEST(InputAssembler, RefusesAnEndBeforeEveryArrayIsWhole) {
  Started s;
  ASSERT_TRUE(s.assembler.Accept(Block(v1::ARRAY_POSITIONS, 0, kPositions)).ok());
  const absl::Status status = s.assembler.Accept(v1::EndOfInput());
  EXPECT_EQ(status.code(), Code::kInvalidArgument);
  EXPECT_THAT(std::string(status.message()), HasSubstr("ARRAY_TRIANGLES had 0 of 12 bytes"));
}

TEST(InputAssembler, RefusesATriangleThatNamesAVertexWhichIsNotThere) {
  Started s;
  const absl::Status status = s.assembler.Accept(Block(v1::ARRAY_TRIANGLES, 0, Bytes<uint32_t>({0, 1, 3})));
  EXPECT_EQ(status.code(), Code::kInvalidArgument);
  EXPECT_EQ(ReasonOf(status).reason, "INDEX_OUT_OF_RANGE");
  EXPECT_EQ(ReasonOf(status).metadata.at("vertex"), "3");
}

TEST(InputAssembler, FindsADamagedBlockByItsChecksum) {
  Started s;
  v1::DataBlock block = Block(v1::ARRAY_POSITIONS, 0, kPositions);
  block.mutable_data()->at(5) ^= 1;
  EXPECT_EQ(s.assembler.Accept(block).code(), Code::kDataLoss);
}

TEST(InputAssembler, FindsADamagedUploadByItsDigest) {
  for (const bool damaged : {false, true}) {
    Started s;
    ASSERT_TRUE(s.assembler.Accept(Block(v1::ARRAY_POSITIONS, 0, kPositions)).ok());
    ASSERT_TRUE(s.assembler.Accept(Block(v1::ARRAY_TRIANGLES, 0, kTriangle)).ok());
    Sha256 hash;
    hash.Update(kPositions);
    hash.Update(damaged ? kPositions : kTriangle);
    v1::EndOfInput end;
    end.set_sha256(hash.Finish());
    EXPECT_EQ(s.assembler.Accept(end).code(), damaged ? Code::kDataLoss : Code::kOk);
  }
}

v1::RemeshRequest RequestWith(v1::DataBlock block) {
  v1::RemeshRequest request;
  *request.mutable_block() = std::move(block);
  return request;
}

TEST(InputAssembler, KnowsTheMemoryThatItsArraysTakeAndWillTake) {
  v1::Header header = TriangleHeader();
  header.mutable_mesh()->set_vertex_count(1'000'000);
  header.mutable_mesh()->set_scalar_type(v1::SCALAR_TYPE_FLOAT32);
  Started s(header);
  EXPECT_EQ(s.assembler.allocated_bytes(), 0u);
  for (uint64_t offset = 0; offset < 12'000'000; offset += 120'000) {
    const v1::RemeshRequest request = RequestWith(Block(v1::ARRAY_POSITIONS, offset, std::string(120'000, '\0')));
    const uint64_t before = s.assembler.allocated_bytes(), at_most = s.assembler.BytesToAccept(request);
    ASSERT_TRUE(s.assembler.AcceptMessage(request).ok());
    const uint64_t after = s.assembler.allocated_bytes();
    EXPECT_GE(after, 2 * (offset + 120'000)) << "floats become doubles";
    EXPECT_EQ(at_most, after == before ? before : before + after) << "the old array stays until it is copied";
  }
  EXPECT_EQ(s.assembler.allocated_bytes(), 24'000'000u);
}

TEST(InputAssembler, CountsFloatsAsTheDoublesTheyBecome) {
  ServerLimits limits;
  limits.max_input_bytes = 30'000'000;
  v1::Header header = TriangleHeader();
  header.mutable_mesh()->set_vertex_count(2'000'000);
  header.mutable_mesh()->set_scalar_type(v1::SCALAR_TYPE_FLOAT32);
  InputAssembler assembler(limits);
  EXPECT_EQ(assembler.Accept(header).code(), Code::kResourceExhausted);
}

TEST(InputAssembler, TakesMemoryForWhatCameNotForWhatWasAnnounced) {
  v1::Header header;
  header.mutable_mesh()->set_vertex_count(50'000'000);  // 1.2 GB
  header.mutable_mesh()->set_triangle_count(50'000'000);
  Started s(header);
  ASSERT_TRUE(s.assembler.Accept(Block(v1::ARRAY_POSITIONS, 0, kPositions)).ok());
  EXPECT_LE(s.assembler.Take().mesh.positions.capacity(), 10'000u);
}

}  // namespace
}  // namespace meshfront
