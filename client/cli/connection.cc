#include "client/cli/connection.h"

#include "core/base/status_macros.h"
#include "server/server.h"

namespace meshfront {
namespace {

class RemoteConnection : public Connection {
 public:
  explicit RemoteConnection(const std::string& address) : client_(CreateRemoteChannel(address)) {}
  RemeshClient& client() override { return client_; }

 private:
  RemeshClient client_;
};

class LocalConnection : public Connection {
 public:
  explicit LocalConnection(std::unique_ptr<InProcess> service)
      : service_(std::move(service)), client_(service_->channel()) {}
  RemeshClient& client() override { return client_; }

 private:
  std::unique_ptr<InProcess> service_;
  RemeshClient client_;
};

}  // namespace

absl::StatusOr<std::unique_ptr<Connection>> Connect(const std::string& address, uint32_t threads) {
  if (!address.empty()) return std::make_unique<RemoteConnection>(address);
  ServerConfig config = InProcess::DefaultConfig();
  if (threads > 0) config.threads = static_cast<int>(threads);
  MESHFRONT_ASSIGN_OR_RETURN(std::unique_ptr<InProcess> service, InProcess::Start(config));
  return std::make_unique<LocalConnection>(std::move(service));
}

}  // namespace meshfront
