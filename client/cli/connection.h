// Where calls go: a remote server, or the same service inside this process.
#pragma once

#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "client/remesh_client.h"

namespace meshfront {

// Owns what the channel needs; outlives every call.
class Connection {
 public:
  virtual ~Connection() = default;
  virtual RemeshClient& client() = 0;
};

// `address` empty: starts the service in this process, reached through gRPC's in-process transport. `threads`: of the job, 0 = all cores.
absl::StatusOr<std::unique_ptr<Connection>> Connect(const std::string& address, uint32_t threads);

}  // namespace meshfront
