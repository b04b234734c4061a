// The client library against a service that plays back a script.
#include "client/remesh_client.h"

#include <grpcpp/server.h>
#include <grpcpp/server_builder.h>

#include <map>
#include <thread>

#include "absl/time/clock.h"
#include "client/mesh_upload.h"
#include "proto/wire/convert.h"
#include "proto/wire/crc32c.h"
#include "proto/wire/errors.h"
#include "proto/wire/sha256.h"
#include "tests/support/matchers.h"
#include "tests/support/shapes.h"

namespace meshfront {
namespace {

using testing::IsOk;
using testing::StatusIs;

// Keeps what it is sent, then plays `responses` and ends with `status`.
class ScriptedService final : public v1::MeshfrontService::Service {
 public:
  using Stream = grpc::ServerReaderWriter<v1::RemeshResponse, v1::RemeshRequest>;

  grpc::Status Remesh(grpc::ServerContext* context, Stream* stream) override {
    if (refuse_at_once) return status;
    v1::RemeshRequest request;
    while (stream->Read(&request)) requests.push_back(request);
    for (const v1::RemeshResponse& response : responses) stream->Write(response);
    while (wait_for_cancel && !context->IsCancelled()) std::this_thread::yield();
    return status;
  }

  std::vector<v1::RemeshRequest> requests;
  std::vector<v1::RemeshResponse> responses;
  grpc::Status status;
  bool refuse_at_once = false, wait_for_cancel = false;
};

class KeepingObserver : public RemeshObserver {
 public:
  void OnUploaded() override { ++uploads; }
  void OnAccepted(const v1::Accepted&) override {
    if (on_accepted) on_accepted();
  }
  absl::Status OnChunk(const v1::Chunk&, const ChunkDecoder& decoded) override {
    triangles += decoded.triangles().size();
    return chunk_status;
  }
  int uploads = 0;
  size_t triangles = 0;
  absl::Status chunk_status;
  std::function<void()> on_accepted;
};

class RemeshClientTest : public ::testing::Test {
 protected:
  RemeshClientTest() {
    grpc::ServerBuilder builder;
    builder.RegisterService(&service_);
    server_ = builder.BuildAndStart();
    client_ = std::make_unique<RemeshClient>(server_->InProcessChannel({}));
  }

  void Play(const v1::Chunk& chunk) { *service_.responses.emplace_back().mutable_event()->mutable_chunk() = chunk; }
  void PlaySummary(uint64_t chunks, uint32_t crc) {
    v1::Summary* summary = service_.responses.emplace_back().mutable_event()->mutable_summary();
    summary->set_chunks(chunks);
    summary->set_chunks_crc32c(crc);
  }
  v1::Chunk OneTriangle() const {
    v1::Chunk chunk;
    chunk.set_vertex_count(3);
    chunk.set_triangle_count(1);
    const float positions[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    const uint32_t indices[3] = {0, 1, 2};
    chunk.set_positions(positions, sizeof(positions));
    chunk.set_indices(indices, sizeof(indices));
    chunk.set_crc32c(ChunkCrc32c(chunk));
    return chunk;
  }
  absl::StatusOr<v1::Summary> Call(const TriangleMesh& mesh = testing::Icosphere(1)) {
    return client_->Remesh(mesh, call_, observer_);
  }

  ScriptedService service_;
  std::unique_ptr<grpc::Server> server_;
  std::unique_ptr<RemeshClient> client_;
  CallOptions call_;
  KeepingObserver observer_;
};

TEST_F(RemeshClientTest, SendsTheMeshBitForBitInCheckedBlocks) {
  const TriangleMesh mesh = testing::Icosphere(6);  // 41 thousand vertices: several blocks
  PlaySummary(0, 0);
  call_.options.set_rho(0.5);
  ASSERT_THAT(Call(mesh), IsOk());
  ASSERT_GE(service_.requests.size(), 4u);
  const v1::Header& header = service_.requests.front().header();
  EXPECT_EQ(header.options().rho(), 0.5);
  EXPECT_EQ(header.mesh().vertex_count(), mesh.positions.size());
  EXPECT_EQ(header.mesh().triangle_count(), mesh.triangles.size());
  std::map<v1::Array, std::string> arrays;
  Sha256 digest;
  for (const v1::RemeshRequest& request : service_.requests) {
    if (!request.has_block()) continue;
    const v1::DataBlock& block = request.block();
    EXPECT_LE(block.data().size(), kMaxBlockBytes);
    EXPECT_EQ(block.crc32c(), Crc32c(block.data()));
    EXPECT_EQ(block.offset(), arrays[block.array()].size());
    arrays[block.array()] += block.data();
    digest.Update(block.data());
  }
  EXPECT_EQ(service_.requests.back().end().sha256(), digest.Finish());
  const absl::string_view positions(reinterpret_cast<const char*>(mesh.positions.data()),
                                    mesh.positions.size() * sizeof(Vec3));
  const absl::string_view triangles(reinterpret_cast<const char*>(mesh.triangles.data()),
                                    mesh.triangles.size() * sizeof(Triangle));
  EXPECT_TRUE(arrays[v1::ARRAY_POSITIONS] == positions);
  EXPECT_TRUE(arrays[v1::ARRAY_TRIANGLES] == triangles);
  EXPECT_EQ(observer_.uploads, 1);
}

TEST_F(RemeshClientTest, AnnouncesAPointSetWithItsNormals) {
  TriangleMesh points = testing::Icosphere(2);
  points.triangles.clear();
  points.normals = points.positions;
  EXPECT_TRUE(HeaderFor(points).points().has_normals());
  EXPECT_EQ(HeaderFor(points).points().point_count(), points.positions.size());
}

TEST_F(RemeshClientTest, ReturnsTheSummaryOfAWholeStream) {
  Play(OneTriangle());
  PlaySummary(1, ExtendChunksCrc32c(0, OneTriangle().crc32c()));
  ASSERT_THAT(Call(), IsOk());
  EXPECT_EQ(observer_.triangles, 1u);
}

TEST_F(RemeshClientTest, ThrowsAwayAStreamWithoutASummary) {
  Play(OneTriangle());
  EXPECT_THAT(Call(), StatusIs(absl::StatusCode::kDataLoss, "without a Summary"));
}

TEST_F(RemeshClientTest, ThrowsAwayAStreamThatLostAChunk) {
  Play(OneTriangle());
  PlaySummary(2, 0);
  EXPECT_THAT(Call(), StatusIs(absl::StatusCode::kDataLoss, "2 chunks"));
}

TEST_F(RemeshClientTest, RefusesADamagedChunk) {
  v1::Chunk chunk = OneTriangle();
  chunk.mutable_positions()->at(0) ^= 1;
  Play(chunk);
  PlaySummary(1, 0);
  EXPECT_THAT(Call(), StatusIs(absl::StatusCode::kDataLoss, "checksum"));
  EXPECT_EQ(observer_.triangles, 0u);
}

TEST_F(RemeshClientTest, RefusesWhatComesAfterTheSummary) {
  PlaySummary(0, 0);
  Play(OneTriangle());
  EXPECT_THAT(Call(), StatusIs(absl::StatusCode::kDataLoss, "after its Summary"));
}

TEST_F(RemeshClientTest, SkipsEventsThatItDoesNotKnow) {
  service_.responses.emplace_back();
  PlaySummary(0, 0);
  EXPECT_THAT(Call(), IsOk());
}

TEST_F(RemeshClientTest, BringsTheErrorOfTheServiceWithItsDetails) {
  service_.status = ToGrpcStatus(absl::FailedPreconditionError("edge 1 2 has three faces"));
  const absl::StatusOr<v1::Summary> result = Call();
  EXPECT_THAT(result, StatusIs(absl::StatusCode::kFailedPrecondition, "edge 1 2 has three faces"));
}

// The service answers before the upload is through: the answer counts, not the broken upload.
TEST_F(RemeshClientTest, BringsTheErrorOfAServiceThatRefusesEarly) {
  service_.refuse_at_once = true;
  service_.status = ToGrpcStatus(absl::ResourceExhaustedError("too large"));
  EXPECT_THAT(Call(testing::Icosphere(6)), StatusIs(absl::StatusCode::kResourceExhausted, "too large"));
}

TEST_F(RemeshClientTest, EndsTheCallWhenTheObserverFails) {
  Play(OneTriangle());
  service_.wait_for_cancel = true;
  observer_.chunk_status = absl::InternalError("disk full");
  EXPECT_THAT(Call(), StatusIs(absl::StatusCode::kInternal, "disk full"));
}

TEST_F(RemeshClientTest, CanBeCancelledBeforeAndWhileItRuns) {
  CallCanceller before;
  before.Cancel();
  call_.canceller = &before;
  service_.wait_for_cancel = true;
  EXPECT_THAT(Call(), StatusIs(absl::StatusCode::kCancelled, ""));
  CallCanceller during;
  call_.canceller = &during;
  service_.responses.emplace_back().mutable_event()->mutable_accepted();
  observer_.on_accepted = [&during] { during.Cancel(); };
  EXPECT_THAT(Call(), StatusIs(absl::StatusCode::kCancelled, ""));
}

TEST_F(RemeshClientTest, EndsAtTheDeadline) {
  service_.wait_for_cancel = true;
  call_.deadline = absl::Now() + absl::Milliseconds(20);
  EXPECT_THAT(Call(), StatusIs(absl::StatusCode::kDeadlineExceeded, ""));
}

TEST(RemeshClient, SaysThatNobodyListens) {
  RemeshClient client(CreateRemoteChannel("127.0.0.1:1"));
  KeepingObserver observer;
  EXPECT_THAT(client.Remesh(testing::Icosphere(1), {}, observer), StatusIs(absl::StatusCode::kUnavailable, ""));
}

TEST_F(RemeshClientTest, TakesAMeshForEachLevel) {
  const v1::Chunk chunk = OneTriangle();
  ChunkDecoder decoder(v1::SCALAR_TYPE_FLOAT32);
  ASSERT_THAT(decoder.Decode(chunk), IsOk());
  for (uint32_t level = 0; level < 2; ++level) {
    Play(chunk);
    PlaySummary(1, decoder.chunks_crc32c());
    service_.responses.back().mutable_event()->mutable_summary()->set_level(level);
  }
  CallOptions call;
  call.options.add_lod_rhos(0.5), call.options.add_lod_rhos(1);
  KeepingObserver observer;
  const auto summaries = client_->RemeshLevels(testing::Icosphere(0), call, observer);
  ASSERT_THAT(summaries, IsOk());
  EXPECT_EQ(summaries->size(), 2u);
  EXPECT_EQ(observer.triangles, 2u);
  EXPECT_THAT(client_->Remesh(testing::Icosphere(0), call, observer),
              StatusIs(absl::StatusCode::kInvalidArgument, "RemeshLevels"));

  service_.responses.pop_back();
  EXPECT_THAT(client_->RemeshLevels(testing::Icosphere(0), call, observer),
              StatusIs(absl::StatusCode::kDataLoss, "1 Summaries; there are 2 levels"));
  PlaySummary(1, decoder.chunks_crc32c());  // of level 0 again
  EXPECT_THAT(client_->RemeshLevels(testing::Icosphere(0), call, observer),
              StatusIs(absl::StatusCode::kDataLoss, "a Summary is of level 0"));
}

}  // namespace
}  // namespace meshfront
