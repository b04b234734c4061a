// Meshes that are kept between calls, under names that can't be guessed.
#pragma once

#include <cstdint>
#include <functional>
#include <list>
#include <map>
#include <memory>
#include <mutex>
#include <string>

#include "absl/status/statusor.h"
#include "absl/time/clock.h"
#include "core/prepared_input.h"
#include "server/config.h"

namespace meshfront {

// Bounded by count and bytes, the one that was used longest ago goes first; what was not used for the time to live is gone. Whoever knows a
// name may use it: the server knows no identities. Of the names only digests are kept. Thread-safe; a mesh that is in use outlives its
// session. Memory of what expired is given back with the next call of any method.
class SessionStore {
 public:
  using Clock = std::function<absl::Time()>;
  explicit SessionStore(const SessionLimits& limits, Clock clock = absl::Now)
      : limits_(limits), clock_(std::move(clock)) {}

  // The name of the new session. ResourceExhausted: it alone is beyond the limits.
  absl::StatusOr<std::string> Keep(std::shared_ptr<const PreparedInput> input);
  // NotFound with the reason SESSION_UNKNOWN. Its time begins anew.
  absl::StatusOr<std::shared_ptr<const PreparedInput>> Find(const std::string& id);

  struct Usage {
    size_t sessions = 0;
    uint64_t bytes = 0;
  };
  Usage usage();
  absl::Duration ttl() const { return limits_.ttl; }

 private:
  struct Session {
    std::string digest;  // of its name
    std::shared_ptr<const PreparedInput> input;
    uint64_t bytes = 0;
    absl::Time used;
  };
  using Sessions = std::list<Session>;
  // Moves what expired, and the oldest beyond what leaves room for `count` more of `bytes`, to `gone`.
  void MakeRoom(size_t count, uint64_t bytes, Sessions& gone);

  const SessionLimits limits_;
  const Clock clock_;
  std::mutex mutex_;
  Sessions sessions_;  // the one used last comes first
  std::map<std::string, Sessions::iterator> by_digest_;
  uint64_t bytes_ = 0;
};

}  // namespace meshfront
