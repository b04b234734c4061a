#include "server/upload_watch.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "proto/wire/errors.h"

namespace meshfront {

UploadWatch::UploadWatch(absl::Duration timeout)
    : timeout_(std::min(timeout, absl::Hours(24))), thread_([this] { Watch(); }) {}

UploadWatch::~UploadWatch() {
  {
    std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

uint64_t UploadWatch::Add(std::shared_ptr<EventStream> events) {
  std::lock_guard lock(mutex_);
  entries_[next_id_] = {std::move(events), absl::Now()};
  // A watch without entries sleeps for the timeout at most, so it need not be woken.
  return next_id_++;
}

void UploadWatch::Touch(uint64_t id) {
  std::lock_guard lock(mutex_);
  if (const auto found = entries_.find(id); found != entries_.end()) found->second.touched = absl::Now();
}

void UploadWatch::Remove(uint64_t id) {
  std::lock_guard lock(mutex_);
  entries_.erase(id);
}

void UploadWatch::End(EventStream& events) const {
  absl::Status status(absl::StatusCode::kAborted, "");  // needs no memory
  try {
    status = WithReason(absl::AbortedError(absl::StrCat("the upload stood still for ", absl::FormatDuration(timeout_))),
                        "UPLOAD_STALLED");
  } catch (...) {
  }
  events.Close(status);
}

void UploadWatch::Watch() {
  std::unique_lock lock(mutex_);
  while (!stopping_) {
    const absl::Time now = absl::Now();
    absl::Time due = now + timeout_;
    std::vector<std::shared_ptr<EventStream>> stalled;
    for (auto it = entries_.begin(); it != entries_.end();) {
      const absl::Time end = it->second.touched + timeout_;
      if (end <= now) {
        stalled.push_back(std::move(it->second.events));
        it = entries_.erase(it);
      } else {
        due = std::min(due, end);
        ++it;
      }
    }
    lock.unlock();  // closing a call may come back here, to Remove
    for (const std::shared_ptr<EventStream>& events : stalled) End(*events);
    stalled.clear();
    lock.lock();
    if (!stopping_) changed_.wait_for(lock, absl::ToChronoMilliseconds(due - now) + std::chrono::milliseconds(1));
  }
}

}  // namespace meshfront
