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

absl::Status CheckRevision(uint64_t wanted, uint64_t there) {
  if (wanted == there) return absl::OkStatus();
  const char* what = wanted < there ? "; the session's mesh was replaced, and is at "
                                    : "; this session's mesh was not replaced so often, and is at ";
  return WithReason(absl::AbortedError(absl::StrCat("session_revision is ", wanted, what, there, " now")),
                    "SESSION_CHANGED", {{"revision", absl::StrCat(there)}});
}

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

absl::Status SessionStore::CheckSize(uint64_t bytes) const {
  if (bytes <= limits_.max_bytes) return absl::OkStatus();
  return WithReason(absl::ResourceExhaustedError(absl::StrCat("the session would take ", bytes,
                                                              " bytes; this server keeps at most ", limits_.max_bytes)),
                    kSessionTooLarge);
}

absl::Status SessionStore::Unknown() const {
  return WithReason(
      absl::NotFoundError(absl::StrCat("session_id is not known to this server: it was not used for ",
                                       absl::FormatDuration(limits_.ttl),
                                       ", made room for others, or the server was started again or is another; "
                                       "send the mesh again")),
      "SESSION_UNKNOWN");
}

absl::StatusOr<std::string> SessionStore::Keep(std::shared_ptr<const PreparedInput> input) {
  const uint64_t bytes = input->bytes();
  if (limits_.max_count < 1) return absl::ResourceExhaustedError("this server keeps no sessions");
  MESHFRONT_RETURN_IF_ERROR(CheckSize(bytes));
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

SessionStore::Session* SessionStore::Touch(const std::string& digest, Sessions& gone) {
  MakeRoom(0, 0, gone);
  const auto found = by_digest_.find(digest);
  if (found == by_digest_.end()) return nullptr;
  sessions_.splice(sessions_.begin(), sessions_, found->second);
  found->second->used = clock_();
  return &*found->second;
}

absl::StatusOr<SessionStore::Kept> SessionStore::Find(const std::string& id) {
  const std::string digest = DigestOf(id);
  Sessions gone;
  std::lock_guard lock(mutex_);
  const Session* session = Touch(digest, gone);
  if (session == nullptr) return Unknown();
  return Kept{session->input, session->revision};
}

absl::StatusOr<uint64_t> SessionStore::Replace(const std::string& id, uint64_t revision,
                                               std::shared_ptr<const PreparedInput> input) {
  const uint64_t bytes = input->bytes();
  MESHFRONT_RETURN_IF_ERROR(CheckSize(bytes));
  const std::string digest = DigestOf(id);
  Sessions gone;  // destroyed after the lock, as is the mesh that was there
  std::lock_guard lock(mutex_);
  Session* session = Touch(digest, gone);
  if (session == nullptr) return Unknown();
  MESHFRONT_RETURN_IF_ERROR(CheckRevision(revision, session->revision));
  bytes_ += bytes - session->bytes;
  session->bytes = bytes;
  session->input.swap(input);
  MakeRoom(0, 0, gone);  // it was used last, and alone it fits
  return ++session->revision;
}

SessionStore::Usage SessionStore::usage() {
  Sessions gone;
  std::lock_guard lock(mutex_);
  MakeRoom(0, 0, gone);
  return {sessions_.size(), bytes_};
}

}  // namespace meshfront
