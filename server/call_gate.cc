#include "server/call_gate.h"

#include <algorithm>

#include "proto/wire/errors.h"

namespace meshfront {

absl::Status CallGate::Enter() {
  std::lock_guard lock(mutex_);
  if (draining_) {
    return WithRetry(
        WithReason(absl::UnavailableError("the server is shutting down; try again, or another one"), "DRAINING"),
        absl::Seconds(1));
  }
  ++inside_;
  return absl::OkStatus();
}

void CallGate::Leave() {
  // Notified under the lock: whoever waits may destroy the gate as soon as it has it.
  std::lock_guard lock(mutex_);
  --inside_;
  left_.notify_all();
}

int CallGate::inside() {
  std::lock_guard lock(mutex_);
  return inside_;
}

void CallGate::Drain() {
  std::lock_guard lock(mutex_);
  draining_ = true;
}

bool CallGate::WaitUntilIdle(absl::Duration timeout) {
  std::unique_lock lock(mutex_);
  return left_.wait_for(lock, absl::ToChronoMilliseconds(std::min(timeout, absl::Hours(24))),
                        [this] { return inside_ == 0; });
}

}  // namespace meshfront
