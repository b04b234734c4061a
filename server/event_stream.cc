// Pump is the one place that acts on the writer. Whoever changes the state calls it; if a thread is in it already,
// that thread looks again before it leaves. So writes never overlap with the end of the call, and no gRPC call is made
// under the lock (its completion may run on the same thread). Rejected: a lock around the writer's calls, which
// deadlocks for that reason.
#include "server/event_stream.h"

#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "proto/wire/errors.h"

namespace meshfront {

void EventStream::Open(v1::MeshEvent first) {
  std::unique_lock lock(mutex_);
  if (final_ && !final_->ok()) return;
  ring_.push_front(std::move(first));
  open_ = true;
  Pump(lock);
}

absl::Status EventStream::Push(v1::MeshEvent event) {
  std::unique_lock lock(mutex_);
  if (absl::Status status = WaitFor(lock, kSlots - 1); !status.ok()) return status;
  ring_.push_back(std::move(event));
  Pump(lock);
  return absl::OkStatus();
}

absl::Status EventStream::Drain() {
  std::unique_lock lock(mutex_);
  return WaitFor(lock, 0);
}

// Waits until at most `most_waiting` events are in the ring. The time allowed starts anew with each event that is
// taken.
absl::Status EventStream::WaitFor(std::unique_lock<std::mutex>& lock, size_t most_waiting) {
  const absl::Time begin = absl::Now();
  const auto timeout = absl::ToChronoMilliseconds(std::min(stall_timeout_, absl::Hours(24)));
  bool stalled = false;
  while (!final_ && !stalled && ring_.size() > most_waiting) {
    const uint64_t before = taken_count_;
    stalled = !taken_.wait_for(lock, timeout, [&] { return final_ || taken_count_ != before; });
  }
  stalled_ += absl::Now() - begin;
  if (final_) return absl::CancelledError("the call has ended");
  if (!stalled) return absl::OkStatus();
  return WithReason(
      absl::AbortedError(absl::StrCat("the reader took nothing for ", absl::FormatDuration(stall_timeout_))),
      "READER_STALLED");
}

void EventStream::SetProgress(const v1::Progress& progress) {
  std::unique_lock lock(mutex_);
  if (final_) return;
  progress_ = progress;
  Pump(lock);
}

void EventStream::Close(const absl::Status& status) {
  std::unique_lock lock(mutex_);
  if (final_) return;
  final_ = status;
  if (!status.ok()) ring_.clear();
  taken_.notify_all();
  Pump(lock);
}

void EventStream::OnWritten(bool ok) {
  std::unique_lock lock(mutex_);
  writing_ = false;
  if (!ok && (!final_ || final_->ok())) {
    final_ = absl::CancelledError("the client is gone");
    ring_.clear();
    taken_.notify_all();
  }
  Pump(lock);
}

void EventStream::Pump(std::unique_lock<std::mutex>& lock) {
  if (pumping_) return;
  pumping_ = true;
  try {
    ActWhilePossible(lock);
  } catch (...) {  // no memory for an event; the next one who comes looks again
    pumping_ = false;
    throw;
  }
  pumping_ = false;
}

void EventStream::ActWhilePossible(std::unique_lock<std::mutex>& lock) {
  while (!ended_) {
    std::optional<v1::MeshEvent> event;
    if (final_ && !final_->ok()) {
      ended_ = true;
    } else if (writing_ || !open_) {
      break;
    } else if (progress_ && taken_count_ > 0) {  // before chunks, which would starve it; after the first event
      *event.emplace().mutable_progress() = *progress_;
      progress_.reset();
    } else if (!ring_.empty()) {
      event = std::move(ring_.front());
      ring_.pop_front();
      ++taken_count_;
      taken_.notify_all();
    } else if (final_) {
      ended_ = true;
    } else {
      break;
    }
    writing_ = event.has_value();
    const absl::Status status = ended_ ? *final_ : absl::OkStatus();
    lock.unlock();
    if (event) {
      writer_->StartEvent(std::move(*event));
    } else {
      writer_->EndCall(status);
    }
    lock.lock();
  }
}

bool EventStream::ended() const {
  std::lock_guard lock(mutex_);
  return ended_;
}

absl::Duration EventStream::stalled() const {
  std::lock_guard lock(mutex_);
  return stalled_;
}

std::optional<absl::Status> EventStream::final_status() const {
  std::lock_guard lock(mutex_);
  return final_;
}

}  // namespace meshfront
