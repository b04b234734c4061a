// The whole service with engines that do what a test says, over gRPC's in-process transport.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include <thread>

#include "proto/wire/crc32c.h"
#include "proto/wire/errors.h"
#include "server/server.h"
#include "tests/server/fakes.h"

namespace meshfront {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

struct Local {
  explicit Local(Engine engine, ServerConfig config = InProcess::DefaultConfig())
      : server(*InProcess::Start(config, std::move(engine))), stub(v1::MeshfrontService::NewStub(server->channel())) {}
  Outcome Remesh(const std::vector<v1::RemeshRequest>& messages) {
    grpc::ClientContext context;
    return Exchange(*stub, context, messages);
  }
  std::unique_ptr<InProcess> server;
  std::unique_ptr<v1::MeshfrontService::Stub> stub;
};

TEST(Service, AnswersAcceptedThenChunksThenOneSummary) {
  Local local(StripEngine(30'000));
  v1::Header header = TriangleHeader();
  header.set_request_id("mine");
  const Outcome outcome = local.Remesh(TriangleRequest(header));
  ASSERT_TRUE(outcome.status.ok()) << outcome.status.error_message();
  ASSERT_NE(outcome.summary(), nullptr);
  EXPECT_EQ(outcome.Count(v1::MeshEvent::kAccepted), 1u);
  EXPECT_EQ(outcome.Count(v1::MeshEvent::kSummary), 1u);
  EXPECT_GE(outcome.Count(v1::MeshEvent::kProgress), 1u);
  ASSERT_TRUE(outcome.events[0].has_accepted());
  EXPECT_EQ(outcome.events[0].accepted().request_id(), "mine");
  EXPECT_EQ(outcome.events[0].accepted().bounds().max().y(), 1);
  uint64_t triangles = 0;
  uint32_t crc = 0;
  for (const v1::MeshEvent& event : outcome.events) {
    if (!event.has_chunk()) continue;
    triangles += event.chunk().triangle_count();
    crc = ExtendChunksCrc32c(crc, ChunkCrc32c(event.chunk()));
  }
  EXPECT_EQ(triangles, 30'000u);
  EXPECT_EQ(outcome.summary()->chunks(), outcome.Count(v1::MeshEvent::kChunk));
  EXPECT_EQ(outcome.summary()->chunks_crc32c(), crc);
  EXPECT_FALSE(outcome.summary()->version().empty());
}

TEST(Service, GivesTheSameChunksEachTime) {
  Local local(StripEngine(30'000));
  const Outcome first = local.Remesh(TriangleRequest()), second = local.Remesh(TriangleRequest());
  ASSERT_NE(first.summary(), nullptr);
  ASSERT_NE(second.summary(), nullptr);
  EXPECT_EQ(first.summary()->chunks(), second.summary()->chunks());
  EXPECT_EQ(first.summary()->chunks_crc32c(), second.summary()->chunks_crc32c());
}

TEST(Service, EstimatesWithOneResponse) {
  Local local(StripEngine(1234));
  grpc::ClientContext context;
  v1::EstimateResponse response;
  const auto writer = local.stub->Estimate(&context, &response);
  for (const v1::RemeshRequest& message : TriangleRequest()) {
    v1::EstimateRequest request;
    ASSERT_TRUE(request.ParseFromString(message.SerializeAsString()));  // the same fields, by design
    ASSERT_TRUE(writer->Write(request));
  }
  writer->WritesDone();
  const grpc::Status status = writer->Finish();
  ASSERT_TRUE(status.ok()) << status.error_message();
  EXPECT_EQ(response.predicted_triangles(), 1234u);
}

TEST(Service, TellsItsLimitsDefaultsAndFormats) {
  Local local(StripEngine(1));
  grpc::ClientContext context;
  v1::GetCapabilitiesResponse response;
  ASSERT_TRUE(local.stub->GetCapabilities(&context, {}, &response).ok());
  EXPECT_EQ(response.limits().max_block_bytes(), 1u << 20);
  EXPECT_EQ(response.limits().default_chunk_bytes(), 128u << 10);
  EXPECT_EQ(response.file_formats_size(), 7);
  EXPECT_EQ(response.default_options().rho(), 0.8);
  EXPECT_THAT(response.supported_options(), ::testing::Contains("options.eta"));
  EXPECT_THAT(response.supported_options(), ::testing::Contains("options.max_error"));
  EXPECT_THAT(response.supported_options(), ::testing::Contains("options.target_triangles"));
  EXPECT_THAT(response.supported_options(), ::testing::Contains("options.region"));
  EXPECT_THAT(response.supported_options(), ::testing::Contains("options.blend"));
  EXPECT_THAT(response.supported_options(), ::testing::Contains("options.features"));
}

TEST(Service, NamesTheFieldOfABadOptionAtOnce) {
  Local local(StripEngine(1));
  v1::Header header = TriangleHeader();
  header.mutable_options()->set_surface(v1::SURFACE_TYPE_MLS);
  header.mutable_options()->mutable_region()->mutable_box();
  const Outcome outcome = local.Remesh(TriangleRequest(header));
  EXPECT_EQ(outcome.status.error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_EQ(outcome.status.error_message(),
            "options.region with options.surface SURFACE_TYPE_MLS is not supported yet");
  EXPECT_EQ(outcome.Count(v1::MeshEvent::kAccepted), 0u);
}

TEST(Service, RefusesAStreamThatEndsBeforeItsInput) {
  Local local(StripEngine(1));
  std::vector<v1::RemeshRequest> messages = TriangleRequest();
  messages.pop_back();
  const Outcome outcome = local.Remesh(messages);
  EXPECT_EQ(outcome.status.error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_THAT(outcome.status.error_message(), HasSubstr("end is missing"));
  EXPECT_EQ(local.Remesh({}).status.error_code(), grpc::StatusCode::INVALID_ARGUMENT);
}

TEST(Service, StopsTheEngineWhenTheClientCancels) {
  auto started = std::make_shared<Signal>(), stopped = std::make_shared<Signal>();
  Local local(EndlessEngine(started, stopped));
  grpc::ClientContext context;
  const auto stream = local.stub->Remesh(&context);
  Send(*stream, TriangleRequest());
  ASSERT_TRUE(started->Wait());
  context.TryCancel();
  EXPECT_TRUE(stopped->Wait());
  EXPECT_EQ(ReadToEnd(*stream).status.error_code(), grpc::StatusCode::CANCELLED);
}

TEST(Service, StopsTheEngineAtTheDeadline) {
  auto started = std::make_shared<Signal>(), stopped = std::make_shared<Signal>();
  Local local(EndlessEngine(started, stopped));
  grpc::ClientContext context;
  context.set_deadline(std::chrono::system_clock::now() + std::chrono::milliseconds(200));
  const Outcome outcome = Exchange(*local.stub, context, TriangleRequest());
  EXPECT_EQ(outcome.status.error_code(), grpc::StatusCode::DEADLINE_EXCEEDED);
  EXPECT_TRUE(!started->IsSet() || stopped->Wait());
}

TEST(Service, LeavesAQueuedJobUndoneWhenItsClientCancels) {
  auto started = std::make_shared<Signal>(), stopped = std::make_shared<Signal>();
  ServerConfig config = InProcess::DefaultConfig();
  config.workers = 1;
  Local local(EndlessEngine(started, stopped), config);
  grpc::ClientContext running_context, queued_context;
  const auto running = local.stub->Remesh(&running_context);
  Send(*running, TriangleRequest());
  ASSERT_TRUE(started->Wait());
  const auto queued = local.stub->Remesh(&queued_context);
  Send(*queued, TriangleRequest());
  v1::RemeshResponse response;
  ASSERT_TRUE(queued->Read(&response));
  EXPECT_EQ(response.event().accepted().queue_position(), 1u);
  queued_context.TryCancel();
  EXPECT_EQ(ReadToEnd(*queued).status.error_code(), grpc::StatusCode::CANCELLED);
  EXPECT_FALSE(stopped->IsSet());
  running_context.TryCancel();
  ReadToEnd(*running);
}

TEST(Service, RefusesAJobThatTheQueueCannotHold) {
  auto started = std::make_shared<Signal>(), stopped = std::make_shared<Signal>();
  ServerConfig config = InProcess::DefaultConfig();
  config.workers = 1;
  config.max_queue = 0;
  Local local(EndlessEngine(started, stopped), config);
  grpc::ClientContext context;
  const auto running = local.stub->Remesh(&context);
  Send(*running, TriangleRequest());
  ASSERT_TRUE(started->Wait());
  const Outcome refused = local.Remesh(TriangleRequest());
  EXPECT_EQ(refused.status.error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED);
  EXPECT_EQ(refused.reason(), "QUEUE_FULL");
  context.TryCancel();
  ReadToEnd(*running);
}

TEST(Service, EndsTheJobOfAReaderThatStandsStill) {
  ServerConfig config = InProcess::DefaultConfig();
  config.stall_timeout = absl::Milliseconds(50);
  Signal ended;
  absl::Status engine_status;
  Engine engine;
  engine.remesh = [&](Problem, MeshSink& sink, const Context& context) {
    absl::StatusOr<Report> report = EmitStrip(10'000'000, sink, context);
    engine_status = report.status();
    ended.Set();
    return report;
  };
  Local local(std::move(engine), config);
  grpc::ClientContext context;
  const auto stream = local.stub->Remesh(&context);
  Send(*stream, TriangleRequest());
  ASSERT_TRUE(ended.Wait());
  EXPECT_EQ(engine_status.code(), absl::StatusCode::kAborted);
  const Outcome outcome = ReadToEnd(*stream);
  EXPECT_EQ(outcome.status.error_code(), grpc::StatusCode::ABORTED);
  EXPECT_EQ(outcome.reason(), "READER_STALLED");
  EXPECT_EQ(outcome.summary(), nullptr);
}

TEST(Service, EndsAnUploadThatStandsStill) {
  ServerConfig config = InProcess::DefaultConfig();
  config.stall_timeout = absl::Milliseconds(20);
  Local local(StripEngine(1), config);
  grpc::ClientContext context;
  const auto stream = local.stub->Remesh(&context);
  stream->Write(TriangleRequest()[0]);
  const Outcome outcome = ReadToEnd(*stream);
  EXPECT_EQ(outcome.status.error_code(), grpc::StatusCode::ABORTED);
  EXPECT_EQ(outcome.reason(), "UPLOAD_STALLED");
}

TEST(Service, EndsAFaultyJobWithItsIdAndNothingOfTheInside) {
  Engine engine;
  engine.remesh = [](Problem problem, MeshSink& sink, const Context& context) -> absl::StatusOr<Report> {
    if (problem.options.eta == 1.5) throw std::runtime_error("secret");
    if (problem.options.eta == 1.6) return absl::InternalError("secret place");
    return EmitStrip(10, sink, context);
  };
  Local local(std::move(engine));
  for (const double eta : {1.5, 1.6}) {
    v1::Header header = TriangleHeader();
    header.mutable_options()->set_eta(eta);
    const Outcome outcome = local.Remesh(TriangleRequest(header));
    EXPECT_EQ(outcome.status.error_code(), grpc::StatusCode::INTERNAL);
    EXPECT_THAT(outcome.status.error_message(), HasSubstr("job j-"));
    EXPECT_THAT(outcome.status.error_message(), Not(HasSubstr("secret")));
  }
  EXPECT_TRUE(local.Remesh(TriangleRequest()).status.ok()) << "the server goes on";
}

TEST(Service, EndsAJobWithoutMemoryWithATimeToRetryAndGoesOn) {
  Engine engine;
  engine.remesh = [](Problem problem, MeshSink& sink, const Context& context) -> absl::StatusOr<Report> {
    if (problem.options.eta == 1.5) throw std::bad_alloc();
    return EmitStrip(10, sink, context);
  };
  Local local(std::move(engine));
  v1::Header header = TriangleHeader();
  header.mutable_options()->set_eta(1.5);
  const Outcome outcome = local.Remesh(TriangleRequest(header));
  EXPECT_EQ(outcome.status.error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED);
  EXPECT_THAT(outcome.status.error_message(), HasSubstr("not enough memory"));
  EXPECT_EQ(outcome.reason(), "OUT_OF_MEMORY");
  EXPECT_TRUE(FromGrpcStatus(outcome.status).GetPayload("type.googleapis.com/google.rpc.RetryInfo"));
  EXPECT_TRUE(local.Remesh(TriangleRequest()).status.ok());
}

TEST(Service, RefusesWhatComesAfterTheEndAndStopsTheJob) {
  const std::vector<v1::RemeshRequest> request = TriangleRequest();
  for (const v1::RemeshRequest& extra : {request[0], request[1], request[3], v1::RemeshRequest()}) {
    auto started = std::make_shared<Signal>(), stopped = std::make_shared<Signal>();
    Local local(EndlessEngine(started, stopped));
    grpc::ClientContext context;
    const auto stream = local.stub->Remesh(&context);
    for (const v1::RemeshRequest& message : request) ASSERT_TRUE(stream->Write(message));
    ASSERT_TRUE(started->Wait());
    stream->Write(extra);
    const Outcome outcome = ReadToEnd(*stream);
    EXPECT_EQ(outcome.status.error_code(), grpc::StatusCode::INVALID_ARGUMENT) << extra.ShortDebugString();
    EXPECT_TRUE(stopped->Wait());
  }
}

TEST(Service, FinishesForACallerThatNeverClosesItsSide) {
  Local local(StripEngine(1000));
  grpc::ClientContext context;
  const auto stream = local.stub->Remesh(&context);
  for (const v1::RemeshRequest& message : TriangleRequest()) ASSERT_TRUE(stream->Write(message));
  const Outcome outcome = ReadToEnd(*stream);
  EXPECT_TRUE(outcome.status.ok()) << outcome.status.error_message();
  EXPECT_NE(outcome.summary(), nullptr);
}

TEST(Service, EndsAJobThatTakesLongerThanTheServerAllows) {
  auto started = std::make_shared<Signal>(), stopped = std::make_shared<Signal>();
  ServerConfig config = InProcess::DefaultConfig();
  config.max_job = absl::Milliseconds(20);
  Local local(EndlessEngine(started, stopped), config);
  const Outcome outcome = local.Remesh(TriangleRequest());
  EXPECT_EQ(outcome.status.error_code(), grpc::StatusCode::DEADLINE_EXCEEDED);
  EXPECT_EQ(outcome.reason(), "JOB_TIME_LIMIT");
  EXPECT_THAT(outcome.status.error_message(), HasSubstr("20ms"));
  grpc::ClientContext context;
  v1::GetCapabilitiesResponse response;
  ASSERT_TRUE(local.stub->GetCapabilities(&context, {}, &response).ok());
  EXPECT_EQ(response.limits().max_job_seconds(), 0.02);
}

TEST(Service, CountsFloatsThatBecomeDoublesAgainstTheMemoryOfAllUploads) {
  ServerConfig config = InProcess::DefaultConfig();
  config.limits.max_pending_bytes = 20 << 20;  // 12 MB on the wire, 24 MB in memory
  Local local(StripEngine(1), config);
  v1::Header header = TriangleHeader();
  header.mutable_mesh()->set_vertex_count(1'000'000);
  header.mutable_mesh()->set_scalar_type(v1::SCALAR_TYPE_FLOAT32);
  std::vector<v1::RemeshRequest> messages = TriangleRequest(header);
  messages.resize(1);
  for (uint64_t offset = 0; offset < 12'000'000; offset += 1'000'000) {
    *messages.emplace_back().mutable_block() = Block(v1::ARRAY_POSITIONS, offset, std::string(1'000'000, '\0'));
  }
  const Outcome outcome = local.Remesh(messages);
  EXPECT_EQ(outcome.status.error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED);
  EXPECT_EQ(outcome.reason(), "MEMORY_FULL");
}

std::string Gzipped(const std::string& text) {
  std::string out(compressBound(text.size()) + 64, '\0');
  z_stream stream{};
  deflateInit2(&stream, Z_BEST_COMPRESSION, Z_DEFLATED, 15 + 16, 8, Z_DEFAULT_STRATEGY);
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(text.data()));
  stream.avail_in = static_cast<uInt>(text.size());
  stream.next_out = reinterpret_cast<Bytef*>(out.data());
  stream.avail_out = static_cast<uInt>(out.size());
  deflate(&stream, Z_FINISH);
  out.resize(stream.total_out);
  deflateEnd(&stream);
  return out;
}

TEST(Service, DecompressesAFileWithinTheMemoryOfAllUploadsOnly) {
  ServerConfig config = InProcess::DefaultConfig();
  config.limits.max_pending_bytes = 4 << 20;
  Local local(StripEngine(1), config);
  const std::string triangle = "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
  for (const size_t padding : {0, 16 << 20}) {
    const std::string file = Gzipped(triangle + std::string(padding, ' '));
    std::vector<v1::RemeshRequest> messages(3);
    messages[0].mutable_header()->mutable_file()->set_size_bytes(file.size());
    messages[0].mutable_header()->mutable_file()->set_name("a.off.gz");
    *messages[1].mutable_block() = Block(v1::ARRAY_FILE, 0, file);
    messages[2].mutable_end();
    const Outcome outcome = local.Remesh(messages);
    EXPECT_EQ(outcome.status.error_code(), padding == 0 ? grpc::StatusCode::OK : grpc::StatusCode::RESOURCE_EXHAUSTED)
        << outcome.status.error_message();
    EXPECT_EQ(outcome.reason(), padding == 0 ? "" : "MEMORY_FULL");
  }
}

TEST(Service, ListsTheDefectsOfAMeshThatMayNotBeRepaired) {
  Engine engine;
  engine.remesh = [](Problem, MeshSink&, const Context&) -> absl::StatusOr<Report> {
    return absl::FailedPreconditionError("face 0 is degenerate");
  };
  Local local(std::move(engine));
  v1::Header header = TriangleHeader();
  header.mutable_options()->set_repair(false);
  std::vector<v1::RemeshRequest> messages = TriangleRequest(header);
  *messages[2].mutable_block() = Block(v1::ARRAY_TRIANGLES, 0, Bytes<uint32_t>({0, 1, 1}));
  const Outcome outcome = local.Remesh(messages);
  EXPECT_EQ(outcome.status.error_code(), grpc::StatusCode::FAILED_PRECONDITION);
  EXPECT_GE(outcome.Count(v1::MeshEvent::kDefect), 1u);
}

TEST(Service, CapsTheThreadsThatACallerAsksFor) {
  std::atomic<int> threads{0};
  Engine engine;
  engine.remesh = [&](Problem, MeshSink&, const Context& context) -> absl::StatusOr<Report> {
    threads = context.threads;
    return Report();
  };
  ServerConfig config = InProcess::DefaultConfig();
  config.threads = 3;
  Local local(std::move(engine), config);
  for (const auto& [asked, given] : std::vector<std::pair<uint32_t, int>>{{0, 3}, {1, 1}, {4'000'000'000u, 3}}) {
    v1::Header header = TriangleHeader();
    header.mutable_options()->set_threads(asked);
    EXPECT_TRUE(local.Remesh(TriangleRequest(header)).status.ok());
    EXPECT_EQ(threads, given);
  }
}

TEST(Service, RunsManyCallsAtATimeAndLosesNone) {
  ServerConfig config = InProcess::DefaultConfig();
  config.max_queue = 1000;
  Local local(StripEngine(500), config);
  std::atomic<int> good{0};
  std::vector<std::thread> callers;
  for (int i = 0; i < 8; ++i) {
    callers.emplace_back([&] {
      for (int j = 0; j < 50; ++j) {
        const Outcome outcome = local.Remesh(TriangleRequest());
        good += outcome.status.ok() && outcome.summary() != nullptr;
      }
    });
  }
  for (std::thread& caller : callers) caller.join();
  EXPECT_EQ(good, 400);
}

TEST(Service, SurvivesCallersThatCancelAtAnyTime) {
  Local local(StripEngine(20'000));
  for (int events = 0; events < 40; ++events) {
    grpc::ClientContext context;
    const auto stream = local.stub->Remesh(&context);
    std::thread writer([&] { Send(*stream, TriangleRequest()); });
    v1::RemeshResponse response;
    for (int i = 0; i < events / 2 && stream->Read(&response); ++i) {
    }
    context.TryCancel();
    writer.join();
    const Outcome outcome = ReadToEnd(*stream);
    EXPECT_TRUE(outcome.status.ok() || outcome.status.error_code() == grpc::StatusCode::CANCELLED);
  }
  EXPECT_TRUE(local.Remesh(TriangleRequest()).status.ok());
}

}  // namespace
}  // namespace meshfront
