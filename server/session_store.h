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
  // A session's mesh, and how often it was replaced.
  struct Kept {
    std::shared_ptr<const PreparedInput> input;
    uint64_t revision = 0;
  };
  // NotFound with the reason SESSION_UNKNOWN. Its time begins anew.
  absl::StatusOr<Kept> Find(const std::string& id);
  // Puts another mesh in the place of the one that is there after `revision` replacements; returns that number plus one. NotFound as of
  // Find; Aborted with the reason SESSION_CHANGED: another mesh is there by now; ResourceExhausted with SESSION_TOO_LARGE: it alone is
  // beyond the limits. The session stays as it is then. Others make room for it.
  absl::StatusOr<uint64_t> Replace(const std::string& id, uint64_t revision,
                                   std::shared_ptr<const PreparedInput> input);

  struct Usage {
    size_t sessions = 0;
    uint64_t bytes = 0;
  };
  Usage usage();
  absl::Duration ttl() const { return limits_.ttl; }
  // ResourceExhausted with the reason SESSION_TOO_LARGE where a session of so many bytes alone is beyond the limits.
  absl::Status CheckSize(uint64_t bytes) const;

 private:
  struct Session {
    std::string digest;  // of its name
    std::shared_ptr<const PreparedInput> input;
    uint64_t bytes = 0;
    absl::Time used;
    uint64_t revision = 0;
  };
  using Sessions = std::list<Session>;
  // The session, now the one used last, or null. What expired goes to `gone`. The mutex is held.
  Session* Touch(const std::string& digest, Sessions& gone);
  absl::Status Unknown() const;
  // Moves what expired, and the oldest beyond what leaves room for `count` more of `bytes`, to `gone`.
  void MakeRoom(size_t count, uint64_t bytes, Sessions& gone);

  const SessionLimits limits_;
  const Clock clock_;
  std::mutex mutex_;
  Sessions sessions_;  // the one used last comes first
  std::map<std::string, Sessions::iterator> by_digest_;
  uint64_t bytes_ = 0;
};

inline constexpr char kSessionTooLarge[] = "SESSION_TOO_LARGE";

// Aborted with the reason SESSION_CHANGED where they differ; the metadata has the revision that is there.
absl::Status CheckRevision(uint64_t wanted, uint64_t there);

}  // namespace meshfront
