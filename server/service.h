// The service: one reactor per call, and what its calls share.
#pragma once

#include <memory>

#include <grpcpp/grpcpp.h>

#include "absl/status/statusor.h"
#include "meshfront/v1/remesh_service.grpc.pb.h"
#include "server/config.h"
#include "server/engine.h"
#include "server/service_state.h"

namespace meshfront {

class Service final : public v1::MeshfrontService::CallbackService {
 public:
  // NotFound when the log can't be opened.
  static absl::StatusOr<std::unique_ptr<Service>> Create(const ServerConfig& config, Engine engine = CoreEngine());

  // New calls are Unavailable from now on.
  void Drain() { state_.gate.Drain(); }
  // Until every call has ended; false when `timeout` passed before.
  bool WaitUntilIdle(absl::Duration timeout) { return state_.gate.WaitUntilIdle(timeout); }

  grpc::ServerBidiReactor<v1::RemeshRequest, v1::RemeshResponse>* Remesh(grpc::CallbackServerContext* context) override;
  grpc::ServerReadReactor<v1::EstimateRequest>* Estimate(grpc::CallbackServerContext* context,
                                                         v1::EstimateResponse* response) override;
  grpc::ServerUnaryReactor* GetCapabilities(grpc::CallbackServerContext* context,
                                            const v1::GetCapabilitiesRequest* request,
                                            v1::GetCapabilitiesResponse* response) override;

  // Serves the metrics over HTTP; see Metrics::Listen.
  absl::StatusOr<std::string> ServeMetrics(const std::string& address) { return state_.metrics.Listen(address); }

 private:
  Service(const ServerConfig& config, Engine engine, std::unique_ptr<JobLog> log)
      : state_(config, std::move(engine), std::move(log)) {}

  ServiceState state_;
};

// What GetCapabilities answers.
v1::GetCapabilitiesResponse CapabilitiesOf(const ServerConfig& config);

}  // namespace meshfront
