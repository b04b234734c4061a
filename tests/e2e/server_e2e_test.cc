// The server as a process: flags, health, reflection, and how it ends.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <signal.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "google/rpc/error_details.pb.h"
#include "grpc/health/v1/health.grpc.pb.h"
#include "grpc/reflection/v1alpha/reflection.grpc.pb.h"
#include "tests/e2e/server_process.h"
#include "tests/support/shapes.h"

namespace meshfront {
namespace {

using grpc::health::v1::Health;
using grpc::health::v1::HealthCheckRequest;
using grpc::health::v1::HealthCheckResponse;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::StartsWith;

// A job of 10 MB of chunks, which runs as long as nobody reads it.
std::vector<v1::RemeshRequest> LongRequest() {
  const TriangleMesh sphere = testing::Icosphere(4);
  v1::Header header = HeaderOf(sphere);
  header.mutable_options()->set_rho(0.012);
  header.mutable_output()->set_scalar_type(v1::SCALAR_TYPE_FLOAT64);
  header.mutable_output()->set_normals(true);
  return RequestOf(sphere, header);
}

grpc::Status AskCapabilities(const ServerProcess& server) {
  grpc::ClientContext context;
  v1::GetCapabilitiesResponse response;
  return server.NewStub()->GetCapabilities(&context, {}, &response);
}

// A connection to a port of this machine.
int ConnectTo(const std::string& address) {
  const int fd = socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in to{};
  to.sin_family = AF_INET;
  to.sin_port = htons(static_cast<uint16_t>(std::stoi(address.substr(address.rfind(':') + 1))));
  to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  EXPECT_EQ(connect(fd, reinterpret_cast<const sockaddr*>(&to), sizeof(to)), 0);
  const timeval patience{20, 0};
  setsockopt(fd, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof(patience));
  return fd;
}

void Say(int fd, const std::string& words) {
  EXPECT_EQ(write(fd, words.data(), words.size()), static_cast<ssize_t>(words.size()));
}

// What an HTTP server answers to GET.
std::string HttpGet(const std::string& address, const std::string& path) {
  const int fd = ConnectTo(address);
  Say(fd, "GET " + path + " HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n");
  std::string answer;
  char buffer[4096];
  for (ssize_t got; (got = read(fd, buffer, sizeof(buffer))) > 0;) answer.append(buffer, static_cast<size_t>(got));
  close(fd);
  return answer;
}

// What meshfrontd prints with --print-config.
nlohmann::json ConfigWith(const std::string& before, const std::string& flags) {
  std::string text;
  std::FILE* pipe = popen((before + " " + MESHFRONTD + " --print-config " + flags).c_str(), "r");
  std::array<char, 4096> bytes;
  while (const size_t count = std::fread(bytes.data(), 1, bytes.size(), pipe)) text.append(bytes.data(), count);
  EXPECT_EQ(pclose(pipe), 0);
  return nlohmann::json::parse(text);
}

TEST(ServerProcess, PrintsTheValuesInForceFromFlagsAndTheirEnvironmentTwins) {
  const nlohmann::json defaults = ConfigWith("", "");
  EXPECT_EQ(defaults["listen"], "127.0.0.1:50051");
  EXPECT_EQ(defaults["stall_timeout"], 30.0);
  const nlohmann::json config = ConfigWith("MESHFRONT_LISTEN=127.0.0.1:7 MESHFRONT_WORKERS=5 MESHFRONT_MAX_QUEUE=9",
                                           "--max-queue 3 --stall-timeout 1.5");
  EXPECT_EQ(config["listen"], "127.0.0.1:7");
  EXPECT_EQ(config["workers"], 5);
  EXPECT_EQ(config["max_queue"], 3) << "a flag goes before its twin";
  EXPECT_EQ(config["stall_timeout"], 1.5);
  EXPECT_EQ(defaults["max_job_seconds"], 0);
  EXPECT_EQ(defaults["max_sessions"], 16);
  EXPECT_EQ(ConfigWith("MESHFRONT_SESSION_TTL=7 MESHFRONT_MAX_SESSION_MB=9", "--max-sessions 3")["session_ttl"], 7);
  EXPECT_EQ(ConfigWith("MESHFRONT_MAX_JOB_SECONDS=7 MESHFRONT_DRAIN_TIMEOUT=8", "")["max_job_seconds"], 7);
}

TEST(ServerProcess, RefusesBadFlagsWithExitCodeTwo) {
  const std::vector<std::vector<std::string>> wrong = {{"--nonsense"},
                                                       {"--workers", "many"},
                                                       {"--listen", "127.0.0.1:0", "--metrics-listen", "0.0.0.0:0"},
                                                       {"--metrics-listen", "foo"},
                                                       {"--listen", "0.0.0.0:0"},
                                                       {"--listen", "127.0.0.1:99999"},
                                                       {"--listen", "127.0.0.1"},
                                                       {"--listen", "foo"},
                                                       {"--max-job-seconds", "-1"}};
  for (const std::vector<std::string>& flags : wrong) {
    std::vector<std::string> arguments = {MESHFRONTD};
    arguments.insert(arguments.end(), flags.begin(), flags.end());
    ChildProcess process(arguments);
    EXPECT_EQ(process.Wait(), 2) << flags[0];
    EXPECT_TRUE(process.ReadLine()) << flags[0] << " was refused without a sentence";
  }
}

TEST(ServerProcess, ListensOffLoopbackOnlyWhenToldThatThisIsInsecure) {
  ChildProcess process({MESHFRONTD, "--listen", "0.0.0.0:0", "--insecure"});
  EXPECT_TRUE(process.ReadLineWith("meshfrontd listening on 0.0.0.0:"));
}

TEST(ServerProcess, TellsPrometheusWhatItHasDone) {
  ServerProcess server({"--metrics-listen", "127.0.0.1:0"});
  const std::optional<std::string> line = server.ReadLineWith("meshfrontd metrics on http://");
  ASSERT_TRUE(line);
  const size_t begin = line->find("http://") + 7;
  const std::string address = line->substr(begin, line->find('/', begin) - begin);
  EXPECT_THAT(HttpGet(address, "/metrics"), AllOf(StartsWith("HTTP/1.1 200"), HasSubstr("\nmeshfront_sessions 0")));
  const TriangleMesh sphere = testing::Icosphere(2);
  v1::Header header = HeaderOf(sphere);
  header.set_keep_session(true);
  grpc::ClientContext context;
  const Outcome outcome = Remesh(*server.NewStub(), context, RequestOf(sphere, header));
  ASSERT_TRUE(outcome.status.ok());
  const std::string calls = "meshfront_calls_total{code=\"OK\",rpc=\"Remesh\"} 1\n";
  std::string answer;
  for (int attempt = 0; attempt < 100 && answer.find(calls) == std::string::npos; ++attempt) {
    answer = HttpGet(address, "/metrics");  // the call ends in the server after it ended here
    usleep(20'000);
  }
  EXPECT_THAT(answer, AllOf(HasSubstr(calls), HasSubstr("\nmeshfront_sessions 1"),
                            HasSubstr("\nmeshfront_stage_seconds_count{stage=\"mesh\"} 1")));
  // Those who connect and say nothing, or half a line, cost the others nothing after a moment.
  std::vector<int> idle;
  for (int i = 0; i < 6; ++i) idle.push_back(ConnectTo(address));
  Say(idle.front(), "GET /m");
  EXPECT_THAT(HttpGet(address, "/else"), StartsWith("HTTP/1.1 404"));
  for (const int fd : idle) close(fd);
}

TEST(ServerProcess, SaysThatAPortIsTaken) {
  ServerProcess first;
  ChildProcess second({MESHFRONTD, "--listen", first.address()});
  EXPECT_EQ(second.Wait(), 5);
  EXPECT_TRUE(second.ReadLineWith("can't listen on " + first.address()));
}

TEST(ServerProcess, IsHealthyAsAWholeAndByService) {
  ServerProcess server;
  const auto stub = Health::NewStub(server.NewChannel());
  for (const char* name : {"", "meshfront.v1.MeshfrontService"}) {
    grpc::ClientContext context;
    HealthCheckRequest request;
    request.set_service(name);
    HealthCheckResponse response;
    ASSERT_TRUE(stub->Check(&context, request, &response).ok()) << name;
    EXPECT_EQ(response.status(), HealthCheckResponse::SERVING);
  }
  grpc::ClientContext context;
  HealthCheckRequest request;
  request.set_service("no.such.Service");
  HealthCheckResponse response;
  EXPECT_EQ(stub->Check(&context, request, &response).error_code(), grpc::StatusCode::NOT_FOUND);
}

TEST(ServerProcess, ListsItsServicesAndHealthByReflection) {
  ServerProcess server;
  const auto stub = grpc::reflection::v1alpha::ServerReflection::NewStub(server.NewChannel());
  grpc::ClientContext context;
  const auto stream = stub->ServerReflectionInfo(&context);
  grpc::reflection::v1alpha::ServerReflectionRequest request;
  request.set_list_services("");
  ASSERT_TRUE(stream->Write(request));
  grpc::reflection::v1alpha::ServerReflectionResponse response;
  ASSERT_TRUE(stream->Read(&response));
  std::vector<std::string> names;
  for (const auto& service : response.list_services_response().service()) names.push_back(service.name());
  EXPECT_THAT(names, Contains("meshfront.v1.MeshfrontService"));
  EXPECT_THAT(names, Contains("grpc.health.v1.Health"));
  stream->WritesDone();
  EXPECT_TRUE(stream->Finish().ok());
}

TEST(ServerProcess, FinishesRunningJobsRefusesNewOnesAndExitsWithZeroOnSigterm) {
  ServerProcess server;
  const auto stub = server.NewStub();
  const auto health = Health::NewStub(server.NewChannel());
  grpc::ClientContext watch_context;
  const auto watch = health->Watch(&watch_context, HealthCheckRequest());
  HealthCheckResponse status;
  ASSERT_TRUE(watch->Read(&status));
  EXPECT_EQ(status.status(), HealthCheckResponse::SERVING);

  grpc::ClientContext context;
  const auto stream = stub->Remesh(&context);
  Send(*stream, LongRequest());
  Outcome outcome;
  while (outcome.chunks == 0) ASSERT_TRUE(ReadEvent(*stream, outcome));

  server.Send(SIGTERM);
  ASSERT_TRUE(watch->Read(&status));
  EXPECT_EQ(status.status(), HealthCheckResponse::NOT_SERVING);
  grpc::ClientContext refused_context;
  Outcome refused = Remesh(*stub, refused_context, LongRequest());
  EXPECT_EQ(refused.status.error_code(), grpc::StatusCode::UNAVAILABLE);
  EXPECT_EQ(refused.reason(), "DRAINING");
  EXPECT_TRUE(refused.DetailOf<google::rpc::RetryInfo>().has_value());

  ReadToEnd(*stream, outcome);
  EXPECT_TRUE(outcome.status.ok()) << outcome.status.error_message();
  EXPECT_TRUE(outcome.summary && !outcome.damaged);
  EXPECT_EQ(server.Wait(), 0) << "a watcher must not hold the shutdown";
}

TEST(ServerProcess, EndsAtOnceOnASecondSignal) {
  ServerProcess server;
  const auto stub = server.NewStub();
  grpc::ClientContext context;
  const auto stream = stub->Remesh(&context);
  Send(*stream, LongRequest());
  Outcome outcome;
  while (outcome.chunks == 0) ASSERT_TRUE(ReadEvent(*stream, outcome));
  server.Send(SIGTERM);
  server.Send(SIGINT);  // another signal: two of one kind may become one
  EXPECT_EQ(server.Wait(), 1);
}

// A reader that stands still keeps its call open for as long as the server lets it.
TEST(ServerProcess, CutsOffWhatIsOpenLongerThanTheDrainTimeoutAndSaysSo) {
  ServerProcess server({"--drain-timeout", "0.05", "--stall-timeout", "1000"});
  const auto stub = server.NewStub();
  grpc::ClientContext context;
  const auto stream = stub->Remesh(&context);
  Send(*stream, LongRequest());
  Outcome outcome;
  while (outcome.chunks == 0) ASSERT_TRUE(ReadEvent(*stream, outcome));
  server.Send(SIGTERM);
  EXPECT_TRUE(server.ReadLineWith("calls were still open"));
  EXPECT_EQ(server.Wait(), 1);
}

TEST(ServerProcess, ExitsWithZeroWhenIdle) {
  ServerProcess server;
  EXPECT_TRUE(AskCapabilities(server).ok());
  server.Send(SIGINT);
  EXPECT_EQ(server.Wait(), 0);
}

TEST(ServerProcess, WritesOneLineOfJsonForEachJob) {
  ServerProcess server;
  grpc::ClientContext context;
  std::vector<v1::RemeshRequest> request = LongRequest();
  request[0].mutable_header()->mutable_options()->set_rho(0.3);
  request[0].mutable_header()->set_request_id("with \"quotes\"");
  ASSERT_TRUE(Remesh(*server.NewStub(), context, request).status.ok());
  const std::optional<std::string> line = server.ReadLine();
  ASSERT_TRUE(line);
  const nlohmann::json json = nlohmann::json::parse(*line);
  EXPECT_EQ(json["code"], "OK");
  EXPECT_EQ(json["rpc"], "Remesh");
  EXPECT_EQ(json["request_id"], "with \"quotes\"");
  EXPECT_GT(json["triangles"], 0);
  EXPECT_GT(json["input_bytes"], 0);
}

}  // namespace
}  // namespace meshfront
