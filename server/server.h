// A server that is up: on a port, or in the process.
#pragma once

#include <memory>
#include <string>

#include <grpcpp/grpcpp.h>

#include "absl/status/statusor.h"
#include "server/config.h"
#include "server/engine.h"
#include "server/health_service.h"
#include "server/service.h"

namespace meshfront {

// Listens from Start until Shutdown. Health is SERVING in between.
class Server {
 public:
  // InvalidArgument: an address off loopback without `insecure`; Unavailable: the port can't be had; NotFound: the log.
  static absl::StatusOr<std::unique_ptr<Server>> Start(const ServerConfig& config, Engine engine = CoreEngine());
  // Ends what still runs.
  ~Server();

  // "127.0.0.1:41234", with the port it got.
  const std::string& address() const { return address_; }
  // … of the metrics; empty where they are not served.
  const std::string& metrics_address() const { return metrics_address_; }

  // NOT_SERVING; after the lame duck new calls are Unavailable; waits until all calls have ended, then shuts down.
  // DeadlineExceeded when that took longer than the drain timeout: calls were cut off, some may hang, and this object can't
  // be destroyed any more; the process must end.
  absl::Status DrainAndShutdown();

 private:
  Server() = default;
  bool ShutdownWithin(absl::Duration flush_time);
  void SetHealth(HealthService::ServingStatus status);

  std::string address_, metrics_address_;
  absl::Duration lame_duck_, drain_timeout_;
  // In the order of dependence: the gRPC server goes first.
  std::unique_ptr<Service> service_;
  HealthService health_;
  std::unique_ptr<grpc::Server> grpc_server_;
};

// The same service over gRPC's in-process transport: no socket, no port. The channel ends with it.
//
//   MESHFRONT_ASSIGN_OR_RETURN(auto local, InProcess::Start());
//   auto stub = v1::MeshfrontService::NewStub(local->channel());
class InProcess {
 public:
  // For one caller in the same process: no log, no queue limit to speak of, and a reader may stand still as long as it
  // likes.
  static ServerConfig DefaultConfig();
  static absl::StatusOr<std::unique_ptr<InProcess>> Start(const ServerConfig& config = DefaultConfig(),
                                                          Engine engine = CoreEngine());
  ~InProcess();

  const std::shared_ptr<grpc::Channel>& channel() const { return channel_; }

 private:
  InProcess() = default;

  std::unique_ptr<Service> service_;
  std::unique_ptr<grpc::Server> grpc_server_;
  std::shared_ptr<grpc::Channel> channel_;
};

}  // namespace meshfront
