// Jobs over a socket: what a caller gets, and what it does to the server when it misbehaves.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <thread>

#include "client/remesh_client.h"
#include "core/mesh/topology.h"
#include "google/rpc/error_details.pb.h"
#include "proto/wire/convert.h"
#include "proto/wire/crc32c.h"
#include "tests/e2e/server_process.h"
#include "tests/support/shapes.h"

namespace meshfront {
namespace {

using ::testing::HasSubstr;
using testing::Icosphere;

// A sphere as fine as `rho` says. Coarse: some thousand triangles; fine: 10 MB of chunks, more than all buffers
// between the engine and a reader that stands still.
constexpr double kCoarse = 0.1, kFine = 0.012;
std::vector<v1::RemeshRequest> SphereRequest(double rho) {
  const TriangleMesh sphere = Icosphere(4);
  v1::Header header = HeaderOf(sphere);
  header.mutable_options()->set_rho(rho);
  header.mutable_output()->set_scalar_type(v1::SCALAR_TYPE_FLOAT64);
  header.mutable_output()->set_normals(true);
  return RequestOf(sphere, header);
}

// Reads until the first chunk; false when the call ended before.
bool ReadFirstChunk(RemeshStream& stream, Outcome& outcome) {
  while (outcome.chunks == 0) {
    if (!ReadEvent(stream, outcome)) return false;
  }
  return true;
}

TEST(RemeshOverSocket, ReturnsAClosedSphereInWholeChunks) {
  ServerProcess server;
  grpc::ClientContext context;
  const Outcome outcome = Remesh(*server.NewStub(), context, SphereRequest(kCoarse));
  ASSERT_TRUE(outcome.status.ok()) << outcome.status.error_message();
  ASSERT_TRUE(outcome.summary.has_value());
  EXPECT_FALSE(outcome.damaged);
  EXPECT_EQ(outcome.chunks, outcome.summary->chunks());
  EXPECT_EQ(outcome.chunks_crc32c, outcome.summary->chunks_crc32c());
  const TopologyReport topology = MeasureTopology(outcome.mesh);
  EXPECT_TRUE(topology.closed && topology.manifold);
  EXPECT_EQ(topology.genus, 0);
  EXPECT_EQ(topology.triangles, outcome.summary->output().triangles());
  EXPECT_GT(outcome.summary->server_peak_rss_bytes(), 1u << 20);
}

// Half of the faces of a sphere, named in an array of their own.
TEST(RemeshOverSocket, SendsThePatchOfARegionAndWhatItReplaces) {
  const TriangleMesh sphere = Icosphere(4);
  std::vector<uint32_t> faces;
  for (uint32_t f = 0; f < sphere.triangles.size(); ++f) {
    const Triangle& t = sphere.triangles[f];
    if (std::all_of(t.begin(), t.end(), [&](VertexId v) { return sphere.PositionAt(v).z > 0; })) faces.push_back(f);
  }
  v1::Header header = HeaderOf(sphere);
  header.mutable_options()->set_rho(0.3);
  header.mutable_options()->mutable_region()->set_face_count(faces.size());
  header.mutable_options()->mutable_region()->set_patch_only(true);
  std::vector<v1::RemeshRequest> messages = RequestOf(sphere, header);
  messages.back().mutable_block()->set_array(v1::ARRAY_REGION_FACES);
  messages.back().mutable_block()->set_data(faces.data(), faces.size() * sizeof(uint32_t));
  messages.back().mutable_block()->set_crc32c(Crc32c(messages.back().block().data()));
  messages.emplace_back().mutable_end();

  ServerProcess server;
  grpc::ClientContext context;
  const auto stub = server.NewStub();
  const auto stream = stub->Remesh(&context);
  Send(*stream, messages);
  std::string removed;
  v1::RemeshResponse response;
  v1::Summary summary;
  while (stream->Read(&response)) {
    if (response.event().has_removed()) {
      EXPECT_EQ(response.event().removed().crc32c(), Crc32c(response.event().removed().faces()));
      removed += response.event().removed().faces();
    }
    if (response.event().has_summary()) summary = response.event().summary();
  }
  const grpc::Status status = stream->Finish();
  ASSERT_TRUE(status.ok()) << status.error_message();
  EXPECT_EQ(removed, std::string(reinterpret_cast<const char*>(faces.data()), faces.size() * sizeof(uint32_t)));
  EXPECT_EQ(summary.region().removed_faces(), faces.size());
  EXPECT_EQ(summary.region().replaced_triangles(), faces.size());
  EXPECT_EQ(summary.region().new_triangles(), summary.output().triangles());
  EXPECT_EQ(summary.output().boundary_loops(), 1u);
}

// The patch of a ball at one end of a sphere.
v1::Header PatchHeader(const v1::Header& of, double z) {
  v1::Header header = of;
  header.mutable_output()->set_scalar_type(v1::SCALAR_TYPE_FLOAT64);
  v1::Region& region = *header.mutable_options()->mutable_region();
  region.mutable_sphere()->mutable_center()->set_z(z);
  region.mutable_sphere()->set_radius(0.5);
  region.set_patch_only(true);
  return header;
}

std::vector<v1::RemeshRequest> SessionRequest(const std::string& id, double z) {
  v1::Header header;
  header.set_session_id(id);
  std::vector<v1::RemeshRequest> messages(2);
  *messages[0].mutable_header() = PatchHeader(header, z);
  messages[1].mutable_end();
  return messages;
}

Outcome RemeshAt(const ServerProcess& server, const std::vector<v1::RemeshRequest>& messages) {
  grpc::ClientContext context;
  return Remesh(*server.NewStub(), context, messages);
}

// What comes of a session is what comes of the mesh sent again, also in two calls at a time.
TEST(RemeshOverSocket, RemeshesRegionAfterRegionOfASession) {
  const TriangleMesh sphere = Icosphere(4);
  const ServerProcess server;
  v1::Header header = PatchHeader(HeaderOf(sphere), 1);
  header.set_keep_session(true);
  const Outcome first = RemeshAt(server, RequestOf(sphere, header));
  ASSERT_TRUE(first.status.ok()) << first.status.error_message();
  ASSERT_TRUE(first.summary->has_session());
  const v1::Session& session = first.summary->session();
  EXPECT_EQ(session.id().size(), 32u);
  EXPECT_EQ(session.ttl_seconds(), 600);
  EXPECT_GT(session.bytes(), sphere.triangles.size() * sizeof(Triangle));

  const Outcome alone = RemeshAt(server, RequestOf(sphere, PatchHeader(HeaderOf(sphere), -1)));
  EXPECT_FALSE(alone.summary->has_session());
  Outcome again[2];
  std::thread beside([&] { again[1] = RemeshAt(server, SessionRequest(session.id(), -1)); });
  again[0] = RemeshAt(server, SessionRequest(session.id(), -1));
  beside.join();
  for (const Outcome& outcome : again) {
    ASSERT_TRUE(outcome.status.ok()) << outcome.status.error_message();
    EXPECT_EQ(outcome.mesh.positions, alone.mesh.positions);
    EXPECT_EQ(outcome.mesh.triangles, alone.mesh.triangles);
    EXPECT_EQ(outcome.summary->session().id(), session.id());
  }
}

// The whole result, in the scalars that sessions keep.
Outcome WholeOf(const ServerProcess& server, const TriangleMesh& mesh, double z) {
  v1::Header header = PatchHeader(HeaderOf(mesh), z);
  header.mutable_options()->mutable_region()->set_patch_only(false);
  Outcome outcome = RemeshAt(server, RequestOf(mesh, header));
  EXPECT_TRUE(outcome.status.ok()) << outcome.status.error_message();
  return outcome;
}

std::vector<v1::RemeshRequest> UpdateRequest(const std::string& id, double z) {
  std::vector<v1::RemeshRequest> messages = SessionRequest(id, z);
  messages[0].mutable_header()->set_update_session(true);
  return messages;
}

// The second patch overlaps the first, and is one of what that left: by a sphere, and by the numbers of faces.
TEST(RemeshOverSocket, LetsPatchesAccumulateInASession) {
  const TriangleMesh sphere = Icosphere(4);
  const ServerProcess server;
  const Outcome first = WholeOf(server, sphere, 1), second = WholeOf(server, first.mesh, 0.8);
  ASSERT_NE(second.mesh.positions, WholeOf(server, sphere, 0.8).mesh.positions) << "no other than of the first";

  v1::Header header = PatchHeader(HeaderOf(sphere), 1);
  header.set_keep_session(true);
  header.set_update_session(true);  // the result is what is kept, from the first call on
  const Outcome kept = RemeshAt(server, RequestOf(sphere, header));
  ASSERT_TRUE(kept.status.ok()) << kept.status.error_message();
  const std::string id = kept.summary->session().id();
  EXPECT_EQ(kept.summary->session().revision(), 0u) << "nothing was there that it could replace";
  std::vector<v1::RemeshRequest> of_kept = UpdateRequest(id, 0.8);
  of_kept[0].mutable_header()->mutable_output()->set_scalar_type(
      v1::SCALAR_TYPE_FLOAT32);  // what is sent is not what is kept
  const Outcome patch = RemeshAt(server, of_kept);
  ASSERT_TRUE(patch.status.ok()) << patch.status.error_message();
  EXPECT_EQ(patch.summary->session().revision(), 1u);
  EXPECT_EQ(patch.mesh.triangles.size(), second.summary->region().new_triangles());

  // By numbers: the faces of the second whole mesh, all of the ball at the other end.
  std::vector<uint32_t> faces;
  for (uint32_t f = 0; f < second.mesh.triangles.size(); ++f) {
    const Triangle& t = second.mesh.triangles[f];
    if (std::all_of(t.begin(), t.end(), [&](VertexId v) { return second.mesh.PositionAt(v).z > 0.7; }))
      faces.push_back(f);
  }
  const auto numbered = [&](v1::Header of, std::vector<v1::RemeshRequest> messages) {
    of.mutable_options()->mutable_region()->set_patch_only(false);
    of.mutable_options()->mutable_region()->set_face_count(faces.size());
    *messages[0].mutable_header() = of;
    v1::DataBlock& block = *messages.back().mutable_block();
    block.set_array(v1::ARRAY_REGION_FACES);
    block.set_data(faces.data(), faces.size() * sizeof(uint32_t));
    block.set_crc32c(Crc32c(block.data()));
    messages.emplace_back().mutable_end();
    return RemeshAt(server, messages);
  };
  const Outcome sent_again =
      numbered(PatchHeader(HeaderOf(second.mesh), 0), RequestOf(second.mesh, HeaderOf(second.mesh)));
  const Outcome of_session = numbered(SessionRequest(id, 0)[0].header(), SessionRequest(id, 0));
  ASSERT_TRUE(of_session.status.ok()) << of_session.status.error_message();
  EXPECT_EQ(of_session.mesh.positions, sent_again.mesh.positions);
  EXPECT_EQ(of_session.mesh.triangles, sent_again.mesh.triangles);
  EXPECT_EQ(of_session.summary->session().revision(), 1u) << "it changed nothing";
}

// Texture coordinates and groups of both patches are those of the mesh sent twice.
TEST(RemeshOverSocket, KeepsTheAttributesOfWhatAccumulates) {
  TriangleMesh sphere = Icosphere(3);
  MeshAttributes& a = sphere.attributes;
  a.channels = {{"TEXCOORD_0", 2}};
  for (const Triangle& t : sphere.triangles)
    a.corners.push_back({t[0].index(), t[1].index(), t[2].index()}), a.groups.push_back(a.groups.size() % 640 < 320);
  for (const Vec3& p : sphere.positions)
    a.values.insert(a.values.end(), {static_cast<float>(p.x), static_cast<float>(p.y)});
  const ServerProcess server;
  RemeshClient client(CreateRemoteChannel(server.address()));
  const auto remesh = [&](TriangleMesh mesh, CallOptions call, double z) {
    call.options = PatchHeader({}, z).options();
    call.options.mutable_region()->set_patch_only(false);
    call.output.set_scalar_type(v1::SCALAR_TYPE_FLOAT64);
    struct : RemeshObserver {
      absl::Status OnChunk(const v1::Chunk&, const ChunkDecoder& chunk) override {
        const auto append = [](auto& to, const auto& from) { to.insert(to.end(), from.begin(), from.end()); };
        for (const SpooledVertex& v : chunk.vertices()) mesh.positions.push_back(v.position);
        append(mesh.triangles, chunk.triangles());
        append(mesh.attributes.values, chunk.wedge_values()), append(mesh.attributes.corners, chunk.corner_wedges());
        append(mesh.attributes.groups, chunk.groups());
        return absl::OkStatus();
      }
      TriangleMesh mesh;
    } observer;
    const absl::StatusOr<v1::Summary> summary = client.Remesh(std::move(mesh), call, observer);
    EXPECT_TRUE(summary.ok()) << summary.status();
    observer.mesh.attributes.channels = {{"TEXCOORD_0", 2}};
    return std::pair(std::move(observer.mesh), summary.value_or(v1::Summary()));
  };
  CallOptions keep;
  keep.keep_session = keep.update_session = true;
  const auto [first, summary] = remesh(sphere, keep, 1);
  CallOptions of_session;
  of_session.session_id = summary.session().id();
  of_session.session_revision = 0;
  const TriangleMesh second = remesh({}, of_session, 0.8).first, twice = remesh(first, {}, 0.8).first;
  EXPECT_EQ(second.positions, twice.positions);
  EXPECT_EQ(second.triangles, twice.triangles);
  EXPECT_EQ(second.attributes.values, twice.attributes.values);
  EXPECT_EQ(second.attributes.corners, twice.attributes.corners);
  EXPECT_EQ(second.attributes.groups, twice.attributes.groups);
  EXPECT_GT(second.attributes.values.size(), 100u);
}

TEST(RemeshOverSocket, RefusesWhatIsMeantOfAnotherMeshOfTheSession) {
  const TriangleMesh sphere = Icosphere(3);
  const ServerProcess server;
  v1::Header header = HeaderOf(sphere);
  header.set_update_session(true);
  EXPECT_THAT(RemeshAt(server, RequestOf(sphere, header)).status.error_message(),
              HasSubstr("it needs session_id or keep_session"));
  header.set_update_session(false);
  header.set_session_revision(0);
  EXPECT_THAT(RemeshAt(server, RequestOf(sphere, header)).status.error_message(), HasSubstr("it needs session_id"));
  header.clear_session_revision();
  header.set_keep_session(true);
  const std::string id = RemeshAt(server, RequestOf(sphere, header)).summary->session().id();
  EXPECT_EQ(RemeshAt(server, UpdateRequest(id, 1)).summary->session().revision(), 1u);
  std::vector<v1::RemeshRequest> again = UpdateRequest(id, 1);  // a retry, whose first answer was lost
  again[0].mutable_header()->set_session_revision(0);
  const Outcome late = RemeshAt(server, again);
  EXPECT_EQ(late.status.error_code(), grpc::StatusCode::ABORTED);
  EXPECT_EQ(late.reason(), "SESSION_CHANGED");
  EXPECT_EQ(late.chunks, 0u) << "it was known before";
  again[0].mutable_header()->set_session_revision(1);
  const Outcome then = RemeshAt(server, again);
  ASSERT_TRUE(then.status.ok()) << then.status.error_message();
  EXPECT_EQ(then.summary->session().revision(), 2u);
}

// 33,000 triangles take 1.5 MB, 130,000 are known to be too many before one of them is made.
TEST(RemeshOverSocket, KeepsASessionWhoseUpdateIsTooLarge) {
  const TriangleMesh sphere = Icosphere(3);
  const ServerProcess server({"--max-session-mb", "1"});
  v1::Header header = HeaderOf(sphere);
  header.set_keep_session(true);
  const v1::Session session = RemeshAt(server, RequestOf(sphere, header)).summary->session();
  std::vector<v1::RemeshRequest> large = UpdateRequest(session.id(), 1);
  v1::RemeshOptions& options = *large[0].mutable_header()->mutable_options();
  options.clear_region();  // all of it
  options.set_rho(0.03);
  const Outcome sent = RemeshAt(server, large);
  ASSERT_TRUE(sent.status.ok()) << sent.status.error_message();
  EXPECT_GT(sent.mesh.triangles.size(), 30'000u);
  EXPECT_EQ(sent.summary->session().update_refusal(), "SESSION_TOO_LARGE");
  EXPECT_EQ(sent.summary->session().revision(), 0u);
  EXPECT_EQ(sent.summary->session().bytes(), session.bytes());
  EXPECT_THAT(sent.summary->warnings(), ::testing::Contains(HasSubstr("is not replaced, and stays at revision 0")));

  options.set_rho(0.015);
  const Outcome refused = RemeshAt(server, large);
  EXPECT_EQ(refused.status.error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED);
  EXPECT_EQ(refused.reason(), "SESSION_TOO_LARGE");
  EXPECT_EQ(refused.chunks, 0u);

  header.set_update_session(true);
  *header.mutable_options() = options;
  const Outcome opened = RemeshAt(server, RequestOf(sphere, header));
  ASSERT_TRUE(opened.status.ok()) << opened.status.error_message();
  EXPECT_FALSE(opened.summary->has_session());
  EXPECT_THAT(opened.summary->warnings(), ::testing::Contains(HasSubstr("no session is kept")));

  const Outcome small = RemeshAt(server, UpdateRequest(session.id(), 1));
  ASSERT_TRUE(small.status.ok()) << small.status.error_message();
  EXPECT_EQ(small.summary->session().revision(), 1u);
  EXPECT_EQ(small.summary->session().update_refusal(), "");
}

TEST(RemeshOverSocket, SaysThatASessionIsGone) {
  const TriangleMesh sphere = Icosphere(3);
  const ServerProcess server({"--max-sessions", "1"});
  std::string ids[2];
  for (std::string& id : ids) {
    v1::Header header = HeaderOf(sphere);
    header.set_keep_session(true);
    const Outcome kept = RemeshAt(server, RequestOf(sphere, header));
    ASSERT_TRUE(kept.status.ok()) << kept.status.error_message();
    id = kept.summary->session().id();
  }
  const Outcome gone = RemeshAt(server, SessionRequest(ids[0], 1)), there = RemeshAt(server, SessionRequest(ids[1], 1));
  EXPECT_EQ(gone.status.error_code(), grpc::StatusCode::NOT_FOUND);
  EXPECT_EQ(gone.reason(), "SESSION_UNKNOWN");
  EXPECT_THAT(gone.status.error_message(), HasSubstr("send the mesh again"));
  EXPECT_TRUE(there.status.ok());
}

TEST(RemeshOverSocket, WarnsWhereNoSessionIsKept) {
  const ServerProcess server({"--max-sessions", "0"});
  const TriangleMesh sphere = Icosphere(3);
  v1::Header header = HeaderOf(sphere);
  header.set_keep_session(true);
  const Outcome outcome = RemeshAt(server, RequestOf(sphere, header));
  ASSERT_TRUE(outcome.status.ok()) << outcome.status.error_message();
  EXPECT_FALSE(outcome.summary->has_session());
  EXPECT_THAT(outcome.summary->warnings(), ::testing::Contains(HasSubstr("no session is kept")));
}

TEST(RemeshOverSocket, ReturnsTheRestOfARegionBitForBitAndNamesTheFieldOfAnEmptyOne) {
  const TriangleMesh sphere = Icosphere(4);
  v1::Header header = HeaderOf(sphere);
  header.mutable_output()->set_scalar_type(v1::SCALAR_TYPE_FLOAT64);
  header.mutable_options()->mutable_region()->mutable_sphere()->mutable_center()->set_z(1);
  header.mutable_options()->mutable_region()->mutable_sphere()->set_radius(0.5);
  ServerProcess server;
  grpc::ClientContext context;
  const Outcome outcome = Remesh(*server.NewStub(), context, RequestOf(sphere, header));
  ASSERT_TRUE(outcome.status.ok()) << outcome.status.error_message();
  EXPECT_TRUE(MeasureTopology(outcome.mesh).closed);
  const uint64_t kept = outcome.summary->region().kept_triangles();
  ASSERT_GT(kept, sphere.triangles.size() / 2);
  size_t at = 0;  // the rest comes first, in its order
  for (const Triangle& t : sphere.triangles) {
    if (at == kept) break;
    const Triangle& other = outcome.mesh.triangles[at];
    at += sphere.PositionAt(t[0]) == outcome.mesh.PositionAt(other[0]) &&
          sphere.PositionAt(t[1]) == outcome.mesh.PositionAt(other[1]) &&
          sphere.PositionAt(t[2]) == outcome.mesh.PositionAt(other[2]);
  }
  EXPECT_EQ(at, kept);

  header.mutable_options()->mutable_region()->mutable_sphere()->set_radius(1e-3);
  grpc::ClientContext again;
  const Outcome empty = Remesh(*server.NewStub(), again, RequestOf(sphere, header));
  EXPECT_EQ(empty.status.error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_THAT(empty.status.error_message(), HasSubstr("options.region is empty"));
}

TEST(RemeshOverSocket, TakesAWholeFileToo) {
  const std::string off = "OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n";
  v1::Header header;
  header.mutable_file()->set_size_bytes(off.size());
  header.mutable_file()->set_name("tetrahedron.off");
  std::vector<v1::RemeshRequest> messages = RequestOf(TriangleMesh(), header);
  v1::RemeshRequest block = SphereRequest(kCoarse)[1];
  block.mutable_block()->set_array(v1::ARRAY_FILE);
  block.mutable_block()->set_data(off);
  block.mutable_block()->set_crc32c(0);
  ServerProcess server;
  for (const bool damaged : {true, false}) {
    if (!damaged) block.mutable_block()->set_crc32c(Crc32c(off));
    grpc::ClientContext context;
    v1::RemeshRequest end;
    end.mutable_end();
    const Outcome outcome = Remesh(*server.NewStub(), context, {messages[0], block, end});
    if (damaged) {
      EXPECT_EQ(outcome.status.error_code(), grpc::StatusCode::DATA_LOSS);
    } else {
      ASSERT_TRUE(outcome.status.ok()) << outcome.status.error_message();
      EXPECT_EQ(outcome.summary->input().topology().triangles(), 4u);
    }
  }
}

TEST(RemeshOverSocket, StopsTheWorkWhenTheCallerCancelsInTheMiddle) {
  ServerProcess server({"--workers", "1"});
  const auto stub = server.NewStub();
  grpc::ClientContext context;
  const auto stream = stub->Remesh(&context);
  Send(*stream, SphereRequest(kFine));
  Outcome outcome;
  ASSERT_TRUE(ReadFirstChunk(*stream, outcome));
  context.TryCancel();
  ReadToEnd(*stream, outcome);
  EXPECT_EQ(outcome.status.error_code(), grpc::StatusCode::CANCELLED);
  EXPECT_FALSE(outcome.summary.has_value());
  EXPECT_TRUE(server.ReadLineWith("\"code\":\"CANCELLED\""));
  // The one worker is free again.
  grpc::ClientContext next;
  EXPECT_TRUE(Remesh(*stub, next, SphereRequest(kCoarse)).status.ok());
}

TEST(RemeshOverSocket, StopsTheWorkAtTheDeadline) {
  ServerProcess server({"--workers", "1"});
  const auto stub = server.NewStub();
  {
    grpc::ClientContext connecting;  // so that the deadline below falls into the work, not into the connection
    ASSERT_TRUE(Remesh(*stub, connecting, SphereRequest(kCoarse)).status.ok());
    ASSERT_TRUE(server.ReadLineWith("\"code\":\"OK\""));
  }
  grpc::ClientContext context;
  context.set_deadline(std::chrono::system_clock::now() + std::chrono::milliseconds(500));
  const Outcome outcome = Remesh(*stub, context, SphereRequest(0.002));
  EXPECT_EQ(outcome.status.error_code(), grpc::StatusCode::DEADLINE_EXCEEDED);
  EXPECT_FALSE(outcome.summary.has_value());
  // The server's clock for the call starts when the headers come, so that on a busy machine the client's reset may be there
  // first: then it is a cancellation.
  const std::optional<std::string> ended = server.ReadLineWith("\"code\":\"");
  ASSERT_TRUE(ended);
  EXPECT_THAT(*ended, ::testing::AnyOf(HasSubstr("DEADLINE_EXCEEDED"), HasSubstr("CANCELLED")));
  // Either way the one worker is free: the job above would have kept it for minutes.
  grpc::ClientContext next;
  EXPECT_TRUE(Remesh(*stub, next, SphereRequest(kCoarse)).status.ok());
}

TEST(RemeshOverSocket, RefusesAMessageThatIsTooLargeAndGoesOn) {
  ServerProcess server;
  const auto stub = server.NewStub();
  for (const size_t bytes : {size_t{2} << 20, size_t{kMaxBlockBytes} + 1}) {
    std::vector<v1::RemeshRequest> messages = SphereRequest(kCoarse);
    messages[1].mutable_block()->set_data(std::string(bytes, 'x'));
    grpc::ClientContext context;
    const Outcome outcome = Remesh(*stub, context, messages);
    // Beyond what a message may have gRPC itself refuses; a block that is only a little too long gets an answer of
    // ours.
    const bool ours = bytes == kMaxBlockBytes + 1;
    EXPECT_EQ(outcome.status.error_code(),
              ours ? grpc::StatusCode::INVALID_ARGUMENT : grpc::StatusCode::RESOURCE_EXHAUSTED);
    EXPECT_EQ(outcome.status.error_message().find("block.data") == 0, ours);
  }
  grpc::ClientContext next;
  EXPECT_TRUE(Remesh(*stub, next, SphereRequest(kCoarse)).status.ok());
}

TEST(RemeshOverSocket, NamesThePathOfABadOptionInTheDetails) {
  ServerProcess server;
  std::vector<v1::RemeshRequest> messages = SphereRequest(kCoarse);
  messages[0].mutable_header()->mutable_options()->set_eta(2.5);
  grpc::ClientContext context;
  const Outcome outcome = Remesh(*server.NewStub(), context, messages);
  EXPECT_EQ(outcome.status.error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  const auto bad = outcome.DetailOf<google::rpc::BadRequest>();
  ASSERT_TRUE(bad.has_value());
  EXPECT_EQ(bad->field_violations(0).field(), "options.eta");
  EXPECT_FALSE(outcome.reason().empty());
  EXPECT_LT(outcome.status.error_details().size(), 8192u);
}

TEST(RemeshOverSocket, RefusesMessagesInTheWrongOrder) {
  ServerProcess server;
  const auto stub = server.NewStub();
  const std::vector<v1::RemeshRequest> good = SphereRequest(kCoarse);
  const std::vector<std::vector<v1::RemeshRequest>> wrong = {
      {good[1], good[0]}, {good.back()}, {good[0], good[0]}, {good[0], good.back()}, {v1::RemeshRequest()}, {}};
  for (const std::vector<v1::RemeshRequest>& messages : wrong) {
    grpc::ClientContext context;
    const Outcome outcome = Remesh(*stub, context, messages);
    EXPECT_EQ(outcome.status.error_code(), grpc::StatusCode::INVALID_ARGUMENT) << outcome.status.error_message();
  }
}

TEST(RemeshOverSocket, TellsDamagedBlocksAndUploadsFromBadOnes) {
  ServerProcess server;
  const auto stub = server.NewStub();
  for (const bool block : {true, false}) {
    std::vector<v1::RemeshRequest> messages = SphereRequest(kCoarse);
    if (block) {
      messages[1].mutable_block()->mutable_data()->at(100) ^= 1;
    } else {
      messages.back().mutable_end()->mutable_sha256()->at(0) ^= 1;
    }
    grpc::ClientContext context;
    const Outcome outcome = Remesh(*stub, context, messages);
    EXPECT_EQ(outcome.status.error_code(), grpc::StatusCode::DATA_LOSS);
    EXPECT_EQ(outcome.reason(), "CHECKSUM_MISMATCH");
  }
}

TEST(RemeshOverSocket, FreesTheWorkerOfACallerThatVanished) {
  ServerProcess server({"--workers", "1"});
  // A caller in a process of its own, killed in the middle: this test's executable again, so that no gRPC state is
  // forked.
  char self[4096] = {};
  ASSERT_GT(readlink("/proc/self/exe", self, sizeof self - 1), 0);
  ChildProcess caller({self, "--gtest_also_run_disabled_tests", "--gtest_filter=*DISABLED_CallsUntilItIsKilled"},
                      {"MESHFRONT_E2E_ADDRESS=" + server.address()});
  ASSERT_TRUE(caller.ReadLineWith("reading")) << "the caller did not get as far as a chunk";
  caller.Send(SIGKILL);
  EXPECT_EQ(caller.Wait(), 128 + SIGKILL);
  EXPECT_TRUE(server.ReadLineWith("\"code\":\"CANCELLED\""));
  grpc::ClientContext context;
  EXPECT_TRUE(Remesh(*server.NewStub(), context, SphereRequest(kCoarse)).status.ok());
}

// Not a test: the caller of the test above.
TEST(RemeshOverSocket, DISABLED_CallsUntilItIsKilled) {
  const char* address = std::getenv("MESHFRONT_E2E_ADDRESS");
  if (address == nullptr) GTEST_SKIP() << "only useful to another test";
  const auto stub = v1::MeshfrontService::NewStub(grpc::CreateChannel(address, grpc::InsecureChannelCredentials()));
  grpc::ClientContext context;
  const auto stream = stub->Remesh(&context);
  Send(*stream, SphereRequest(kFine));
  Outcome outcome;
  if (ReadFirstChunk(*stream, outcome)) std::fputs("reading\n", stderr);
  pause();
}

TEST(RemeshOverSocket, HoldsLittleForAReaderThatStandsStill) {
  const std::vector<v1::RemeshRequest> request = SphereRequest(kFine);
  uint64_t fast = 0, slow = 0;
  {
    ServerProcess server;
    grpc::ClientContext context;
    const Outcome outcome = Remesh(*server.NewStub(), context, request);
    ASSERT_TRUE(outcome.status.ok()) << outcome.status.error_message();
    fast = server.PeakRssBytes();
  }
  {
    ServerProcess server({"--stall-timeout", "2"});
    grpc::ClientContext context;
    const auto stub = server.NewStub();
    const auto stream = stub->Remesh(&context);
    Send(*stream, request);
    Outcome outcome;
    ASSERT_TRUE(ReadFirstChunk(*stream, outcome));
    // The server's own clock says when it stood still for long enough to be as full as it gets.
    ASSERT_TRUE(server.ReadLineWith("\"code\":\"ABORTED\""));
    slow = server.PeakRssBytes();
    ReadToEnd(*stream, outcome);
    EXPECT_EQ(outcome.status.error_code(), grpc::StatusCode::ABORTED);
    EXPECT_EQ(outcome.reason(), "READER_STALLED");
  }
  RecordProperty("fast_mib", static_cast<int>(fast >> 20));
  RecordProperty("slow_mib", static_cast<int>(slow >> 20));
  EXPECT_LE(slow, fast + (16u << 20)) << "fast " << fast << ", slow " << slow;
}

TEST(RemeshOverSocket, RefusesWithARetryTimeWhenAllWorkersAndTheQueueAreTaken) {
  ServerProcess server({"--workers", "1", "--max-queue", "0"});
  const auto stub = server.NewStub();
  grpc::ClientContext context;
  const auto stream = stub->Remesh(&context);
  Send(*stream, SphereRequest(kFine));
  Outcome first;
  ASSERT_TRUE(ReadFirstChunk(*stream, first));
  grpc::ClientContext refused_context;
  const Outcome refused = Remesh(*stub, refused_context, SphereRequest(kCoarse));
  EXPECT_EQ(refused.status.error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED);
  EXPECT_EQ(refused.reason(), "QUEUE_FULL");
  EXPECT_TRUE(refused.DetailOf<google::rpc::RetryInfo>().has_value());
  ReadToEnd(*stream, first);
  EXPECT_TRUE(first.status.ok() && first.summary && !first.damaged);
}

TEST(RemeshOverSocket, GivesTheSameChunksAtAnyThreadCount) {
  uint32_t expected = 0;
  for (const char* threads : {"1", "3"}) {
    ServerProcess server({"--threads", threads});
    grpc::ClientContext context;
    const Outcome outcome = Remesh(*server.NewStub(), context, SphereRequest(kCoarse));
    ASSERT_TRUE(outcome.status.ok()) << outcome.status.error_message();
    if (expected == 0) expected = outcome.chunks_crc32c;
    EXPECT_EQ(outcome.chunks_crc32c, expected);
  }
}

// An array of 1.9 GB where there are 700 MB: it grows until no memory is left.
TEST(RemeshOverSocket, EndsAnUploadWithoutMemoryAndGoesOn) {
  ServerProcess server({"--workers", "2", "--threads", "1"}, {}, 700ull << 20);
  const auto stub = server.NewStub();
  {
    grpc::ClientContext context;
    const auto stream = stub->Remesh(&context);
    v1::RemeshRequest request;
    request.mutable_header()->mutable_mesh()->set_vertex_count(80'000'000);
    request.mutable_header()->mutable_mesh()->set_triangle_count(10);
    bool going = stream->Write(request);
    v1::DataBlock& block = *request.mutable_block();
    block.set_array(v1::ARRAY_POSITIONS);
    block.set_data(std::string(1 << 20, '\0'));
    block.set_crc32c(Crc32c(block.data()));
    for (uint64_t i = 0; going && i < 1800; ++i) {
      block.set_offset(i << 20);
      going = stream->Write(request);
    }
    Outcome outcome;
    ReadToEnd(*stream, outcome);
    EXPECT_EQ(outcome.status.error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED) << outcome.status.error_message();
    EXPECT_EQ(outcome.reason(), "OUT_OF_MEMORY");
    EXPECT_TRUE(outcome.DetailOf<google::rpc::RetryInfo>());
  }
  const TriangleMesh sphere = testing::Icosphere(2);
  grpc::ClientContext context;
  EXPECT_TRUE(Remesh(*stub, context, RequestOf(sphere, HeaderOf(sphere))).status.ok()) << "the server goes on";
  server.Send(SIGTERM);
  EXPECT_EQ(server.Wait(), 0);
}

TEST(EstimateOverSocket, PredictsWithoutMeshing) {
  ServerProcess server;
  grpc::ClientContext context;
  v1::EstimateResponse response;
  const auto stub = server.NewStub();
  const auto writer = stub->Estimate(&context, &response);
  for (const v1::RemeshRequest& message : SphereRequest(kFine)) {
    v1::EstimateRequest request;
    ASSERT_TRUE(request.ParseFromString(message.SerializeAsString()));
    ASSERT_TRUE(writer->Write(request));
  }
  writer->WritesDone();
  const grpc::Status status = writer->Finish();
  ASSERT_TRUE(status.ok()) << status.error_message();
  EXPECT_GT(response.predicted_triangles(), 50'000u);
  EXPECT_GT(response.edge_length().max(), 0);
  EXPECT_EQ(response.input().topology().triangles(), 5120u);
}

}  // namespace
}  // namespace meshfront
