// Counts the calls that are open, so that a drain waits for them and for nothing else.
#pragma once

#include <condition_variable>
#include <mutex>

#include "absl/status/status.h"
#include "absl/time/time.h"

namespace meshfront {

// Thread-safe.
class CallGate {
 public:
  // Every call that is let in leaves once. Unavailable with RetryInfo while draining.
  absl::Status Enter();
  void Leave();
  int inside();
  // From now on nobody is let in.
  void Drain();
  // Until everybody has left; false when `timeout` passed before.
  bool WaitUntilIdle(absl::Duration timeout);

 private:
  std::mutex mutex_;
  std::condition_variable left_;
  int inside_ = 0;
  bool draining_ = false;
};

}  // namespace meshfront
