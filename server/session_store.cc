#include "server/session_store.h"

#include <sys/random.h>

#include <utility>

#include "absl/strings/escaping.h"
#include "absl/strings/str_cat.h"
#include "core/base/status_macros.h"
#include "proto/wire/errors.h"
#include "proto/wire/sha256.h"

namespace meshfront {
namespace {

constexpr size_t kNameBytes = 16;

absl::StatusOr<std::string> NewName() {
  char bytes[kNameBytes];
  if (getrandom(bytes, kNameBytes, 0) != static_cast<ssize_t>(kNameBytes))
    return absl::InternalError("the system has no random numbers for a session's name");
  return absl::BytesToHexString(absl::string_view(bytes, kNameBytes));
}

// How long a look-up takes tells of the digest at most.
std::string DigestOf(const std::string& id) {
  Sha256 sha256;
  sha256.Update(id);
  return sha256.Finish();
}

}  // namespace

void SessionStore::MakeRoom(size_t count, uint64_t bytes, Sessions& gone) {
  const absl::Time oldest = clock_() - limits_.ttl;
  const auto max_count = static_cast<size_t>(limits_.max_count);
  while (!sessions_.empty()) {
    const Session& last = sessions_.back();
    const bool fits = sessions_.size() + count <= max_count && bytes_ + bytes <= limits_.max_bytes;
    if (fits && last.used > oldest) return;
    bytes_ -= last.bytes;
    by_digest_.erase(last.digest);
    gone.splice(gone.end(), sessions_, std::prev(sessions_.end()));
  }
}

absl::StatusOr<std::string> SessionStore::Keep(std::shared_ptr<const PreparedInput> input) {
  const uint64_t bytes = input->bytes();
  if (limits_.max_count < 1) return absl::ResourceExhaustedError("this server keeps no sessions");
  if (bytes > limits_.max_bytes) {
    return absl::ResourceExhaustedError(
        absl::StrCat("the session would take ", bytes, " bytes; this server keeps at most ", limits_.max_bytes));
  }
  MESHFRONT_ASSIGN_OR_RETURN(std::string name, NewName());
  Sessions gone, added;  // destroyed after the lock
  added.push_back({DigestOf(name), std::move(input), bytes, clock_()});
  std::lock_guard lock(mutex_);
  MakeRoom(1, bytes, gone);
  by_digest_.emplace(added.front().digest, added.begin());
  sessions_.splice(sessions_.begin(), added);
  bytes_ += bytes;
  return name;
}

absl::StatusOr<std::shared_ptr<const PreparedInput>> SessionStore::Find(const std::string& id) {
  const std::string digest = DigestOf(id);
  Sessions gone;
  {
    std::lock_guard lock(mutex_);
    MakeRoom(0, 0, gone);
    const auto found = by_digest_.find(digest);
    if (found != by_digest_.end()) {
      sessions_.splice(sessions_.begin(), sessions_, found->second);
      found->second->used = clock_();
      return found->second->input;
    }
  }
  return WithReason(
      absl::NotFoundError(absl::StrCat("session_id is not known to this server: it was not used for ",
                                       absl::FormatDuration(limits_.ttl),
                                       ", made room for others, or is another server's; send the mesh again")),
      "SESSION_UNKNOWN");
}

SessionStore::Usage SessionStore::usage() {
  Sessions gone;
  std::lock_guard lock(mutex_);
  MakeRoom(0, 0, gone);
  return {sessions_.size(), bytes_};
}

}  // namespace meshfront
