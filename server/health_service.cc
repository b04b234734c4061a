#include "server/health_service.h"

#include <vector>

namespace meshfront {

// One Watch call: writes the status at first and whenever it differs from the one written last. All under the
// service's mutex.
class HealthService::Watcher final : public grpc::ServerWriteReactor<Response> {
 public:
  Watcher(HealthService* owner, std::string service) : owner_(owner), service_(std::move(service)) {
    std::lock_guard lock(owner_->mutex_);
    owner_->watchers_.insert(this);
    owner_->ended_ ? End() : Tell();
  }

  // Writes the newest status unless it is known or a write is outstanding.
  void Tell() {
    const ServingStatus status = owner_->StatusOf(service_);
    if (finished_ || writing_ || (told_ && response_.status() == status)) return;
    response_.set_status(status);
    told_ = writing_ = true;
    StartWrite(&response_);
  }
  void End() {
    if (finished_) return;
    finished_ = true;
    Finish(grpc::Status(grpc::StatusCode::UNAVAILABLE, "the server is shutting down"));
  }

  void OnWriteDone(bool ok) override {
    std::lock_guard lock(owner_->mutex_);
    writing_ = false;
    ok ? Tell() : End();
  }
  void OnCancel() override {
    std::lock_guard lock(owner_->mutex_);
    End();
  }
  void OnDone() override {
    {
      std::lock_guard lock(owner_->mutex_);
      owner_->watchers_.erase(this);
    }
    delete this;
  }

 private:
  HealthService* const owner_;
  const std::string service_;
  Response response_;
  bool told_ = false, writing_ = false, finished_ = false;
};

HealthService::ServingStatus HealthService::StatusOf(const std::string& service) const {
  std::lock_guard lock(mutex_);
  const auto found = statuses_.find(service);
  return found == statuses_.end() ? Response::SERVICE_UNKNOWN : found->second;
}

void HealthService::Set(const std::string& service, ServingStatus status) {
  std::lock_guard lock(mutex_);
  statuses_[service] = status;
  for (Watcher* watcher : std::vector<Watcher*>(watchers_.begin(), watchers_.end())) {
    if (watchers_.contains(watcher)) watcher->Tell();
  }
}

void HealthService::EndWatches() {
  std::lock_guard lock(mutex_);
  ended_ = true;
  for (Watcher* watcher : std::vector<Watcher*>(watchers_.begin(), watchers_.end())) {
    if (watchers_.contains(watcher)) watcher->End();
  }
}

grpc::ServerUnaryReactor* HealthService::Check(grpc::CallbackServerContext* context,
                                               const grpc::health::v1::HealthCheckRequest* request,
                                               Response* response) {
  const ServingStatus status = StatusOf(request->service());
  grpc::ServerUnaryReactor* reactor = context->DefaultReactor();
  if (status == Response::SERVICE_UNKNOWN) {
    reactor->Finish(grpc::Status(grpc::StatusCode::NOT_FOUND, "unknown service"));
  } else {
    response->set_status(status);
    reactor->Finish(grpc::Status::OK);
  }
  return reactor;
}

grpc::ServerWriteReactor<HealthService::Response>* HealthService::Watch(
    grpc::CallbackServerContext*, const grpc::health::v1::HealthCheckRequest* request) {
  return new Watcher(this, request->service());
}

}  // namespace meshfront
