// grpc.health.v1 as a service of our own, so that reflection lists it (the built-in one is not listed).
#pragma once

#include <map>
#include <mutex>
#include <set>
#include <string>

#include <grpcpp/grpcpp.h>

#include "grpc/health/v1/health.grpc.pb.h"

namespace meshfront {

// Knows the whole server ("") and the services it was told of. Thread-safe.
class HealthService final : public grpc::health::v1::Health::CallbackService {
 public:
  using Response = grpc::health::v1::HealthCheckResponse;
  using ServingStatus = Response::ServingStatus;

  // Of `service`, from now on; every watcher of it is told.
  void Set(const std::string& service, ServingStatus status);
  // Ends all Watch calls, also those to come: they would hold a shutdown.
  void EndWatches();

  grpc::ServerUnaryReactor* Check(grpc::CallbackServerContext* context,
                                  const grpc::health::v1::HealthCheckRequest* request, Response* response) override;
  grpc::ServerWriteReactor<Response>* Watch(grpc::CallbackServerContext* context,
                                            const grpc::health::v1::HealthCheckRequest* request) override;

 private:
  class Watcher;
  // SERVICE_UNKNOWN for a service it was not told of.
  ServingStatus StatusOf(const std::string& service) const;

  // Recursive: an action on a watcher may complete, and call back, on the same thread.
  mutable std::recursive_mutex mutex_;
  std::map<std::string, ServingStatus> statuses_;
  std::set<Watcher*> watchers_;
  bool ended_ = false;
};

}  // namespace meshfront
