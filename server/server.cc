#include "server/server.h"

#include <grpcpp/ext/proto_server_reflection_plugin.h>

#include <chrono>
#include <future>
#include <memory>
#include <system_error>
#include <thread>

#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "core/base/status_macros.h"
#include "proto/wire/convert.h"

namespace meshfront {
namespace {

// A block or a chunk, and what stands around it.
constexpr int kMaxMessageBytes = static_cast<int>(kMaxBlockBytes) + (64 << 10);
// A connection carries this many calls at a time; more wait at the client.
constexpr int kMaxStreamsPerConnection = 1000;
constexpr int kKeepaliveTimeoutMs = 10'000;
constexpr int kMinPingIntervalMs = 5'000;
// After all jobs have ended: for their last messages to arrive.
constexpr auto kFlushTime = std::chrono::seconds(5);

void Configure(grpc::ServerBuilder& builder, const ServerConfig& config) {
  builder.SetMaxReceiveMessageSize(kMaxMessageBytes);
  builder.SetMaxSendMessageSize(-1);
  builder.AddChannelArgument(GRPC_ARG_MAX_CONCURRENT_STREAMS, kMaxStreamsPerConnection);
  // One port, one server: a second one is refused instead of getting half of the calls.
  builder.AddChannelArgument(GRPC_ARG_ALLOW_REUSEPORT, 0);
  // A client that froze or lost its network is noticed, whether it has a call or not.
  builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_TIME_MS, static_cast<int>(absl::ToInt64Milliseconds(config.keepalive)));
  builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_TIMEOUT_MS, kKeepaliveTimeoutMs);
  builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_PERMIT_WITHOUT_CALLS, 1);
  builder.AddChannelArgument(GRPC_ARG_HTTP2_MAX_PINGS_WITHOUT_DATA, 0);
  builder.AddChannelArgument(GRPC_ARG_HTTP2_MIN_RECV_PING_INTERVAL_WITHOUT_DATA_MS, kMinPingIntervalMs);
}

// For calls that were cut off to come to their end.
constexpr auto kCutOffTime = std::chrono::seconds(5);

absl::Status CheckReach(absl::string_view flag, const std::string& address, const ServerConfig& config) {
  MESHFRONT_RETURN_IF_ERROR(CheckListenAddress(flag, address));
  if (config.insecure || IsLoopback(address)) return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrCat(
      flag, " is ", address, ", which other machines reach, and there is no TLS; give --insecure to allow it"));
}

std::chrono::system_clock::time_point FlushDeadline() { return std::chrono::system_clock::now() + kFlushTime; }

}  // namespace

absl::StatusOr<std::unique_ptr<Server>> Server::Start(const ServerConfig& config, Engine engine) {
  MESHFRONT_RETURN_IF_ERROR(CheckReach("listen", config.listen, config));
  if (!config.metrics_listen.empty())
    MESHFRONT_RETURN_IF_ERROR(CheckReach("metrics-listen", config.metrics_listen, config));
  auto server = std::unique_ptr<Server>(new Server());
  MESHFRONT_ASSIGN_OR_RETURN(server->service_, Service::Create(config, std::move(engine)));
  server->lame_duck_ = config.lame_duck;
  server->drain_timeout_ = config.drain_timeout;
  server->SetHealth(HealthService::Response::SERVING);
  grpc::reflection::InitProtoReflectionServerBuilderPlugin();
  grpc::ServerBuilder builder;
  Configure(builder, config);
  int port = 0;
  builder.AddListeningPort(config.listen, grpc::InsecureServerCredentials(), &port);
  builder.RegisterService(server->service_.get());
  builder.RegisterService(&server->health_);
  server->grpc_server_ = builder.BuildAndStart();
  if (server->grpc_server_ == nullptr || port == 0) {
    return absl::UnavailableError(absl::StrCat("can't listen on ", config.listen, "; is the port taken?"));
  }
  if (!config.metrics_listen.empty()) {
    MESHFRONT_ASSIGN_OR_RETURN(server->metrics_address_, server->service_->ServeMetrics(config.metrics_listen));
  }
  const bool has_port = config.listen.rfind("unix", 0) != 0;
  server->address_ =
      has_port ? absl::StrCat(config.listen.substr(0, config.listen.rfind(':')), ":", port) : config.listen;
  return server;
}

void Server::SetHealth(HealthService::ServingStatus status) {
  for (const char* name : {"", v1::MeshfrontService::service_full_name()}) health_.Set(name, status);
}

absl::Status Server::DrainAndShutdown() {
  // Without a lame duck, whoever reads NOT_SERVING must find the door closed already.
  if (lame_duck_ <= absl::ZeroDuration()) service_->Drain();
  SetHealth(HealthService::Response::NOT_SERVING);
  std::this_thread::sleep_for(absl::ToChronoMilliseconds(lame_duck_));
  service_->Drain();
  const bool idle = service_->WaitUntilIdle(drain_timeout_);
  health_.EndWatches();
  const bool down = ShutdownWithin(idle ? absl::FromChrono(kFlushTime) : absl::ZeroDuration());
  if (idle && down) return absl::OkStatus();
  return absl::DeadlineExceededError(absl::StrCat("calls were still open ", absl::FormatDuration(drain_timeout_),
                                                  " after the signal to end; they were cut off"));
}

// gRPC waits without limit for the callbacks of a call that hangs, so it does on a thread of its own.
bool Server::ShutdownWithin(absl::Duration flush_time) {
  const auto deadline = std::chrono::system_clock::now() + absl::ToChronoMilliseconds(flush_time);
  const auto down = std::make_shared<std::promise<void>>();
  std::future<void> done = down->get_future();
  try {
    std::thread([server = grpc_server_.get(), deadline, down] {
      server->Shutdown(deadline);
      down->set_value();
    }).detach();
  } catch (const std::system_error&) {  // no room for one more thread: without the limit, then
    grpc_server_->Shutdown(deadline);
    return true;
  }
  return done.wait_until(deadline + kCutOffTime) == std::future_status::ready;
}

Server::~Server() {
  if (grpc_server_ == nullptr) return;
  health_.EndWatches();
  grpc_server_->Shutdown(FlushDeadline());
}

ServerConfig InProcess::DefaultConfig() {
  ServerConfig config;
  config.log = "off";
  config.stall_timeout = absl::InfiniteDuration();
  return config;
}

absl::StatusOr<std::unique_ptr<InProcess>> InProcess::Start(const ServerConfig& config, Engine engine) {
  auto local = std::unique_ptr<InProcess>(new InProcess());
  MESHFRONT_ASSIGN_OR_RETURN(local->service_, Service::Create(config, std::move(engine)));
  grpc::ServerBuilder builder;
  builder.SetMaxReceiveMessageSize(kMaxMessageBytes);
  builder.SetMaxSendMessageSize(-1);
  builder.RegisterService(local->service_.get());
  local->grpc_server_ = builder.BuildAndStart();
  if (local->grpc_server_ == nullptr) return absl::InternalError("the in-process server did not start");
  grpc::ChannelArguments arguments;
  arguments.SetMaxReceiveMessageSize(-1);
  local->channel_ = local->grpc_server_->InProcessChannel(arguments);
  return local;
}

InProcess::~InProcess() {
  channel_.reset();
  if (grpc_server_ != nullptr) grpc_server_->Shutdown(std::chrono::system_clock::now());
}

}  // namespace meshfront
