// What a job tells its caller: a bounded ring between the worker that makes events and the call that writes them.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>

#include "absl/status/status.h"
#include "absl/time/time.h"
#include "meshfront/v1/events.pb.h"

namespace meshfront {

// One call, seen from the ring. Implemented by the Remesh reactor and by tests.
class EventWriter {
 public:
  virtual ~EventWriter() = default;
  // Neither throws. Starts the one outstanding write; EventStream::OnWritten follows when it is done, perhaps before this returns.
  virtual void StartEvent(v1::MeshEvent event) = 0;
  // Ends the call. Once, last: the writer may be gone when it returns.
  virtual void EndCall(const absl::Status& status) = 0;
};

// Thread-safe. Never calls the writer with its lock held, and never from two threads at a time. After the call has
// ended it touches the writer no more and Push answers Cancelled, so that a job may outlive its call.
//
//   call:   Open(accepted): what was pushed before it waits for it
//   worker: Push … Push, Drain, Close(status)            a full ring blocks Push, a stalled reader aborts it
//   call:   OnWritten after each write; Cancel(status) when the peer is gone: the call ends at once
class EventStream {
 public:
  static constexpr size_t kSlots = 8;

  // `writer` lives until its EndCall. `stall_timeout`: how long Push and Drain wait without one event being taken.
  EventStream(EventWriter* writer, absl::Duration stall_timeout) : writer_(writer), stall_timeout_(stall_timeout) {}

  // The first event; nothing is written before it. Once.
  void Open(v1::MeshEvent first);
  // Hands over an event in order; blocks while the ring is full. Aborted when the reader stalls, Cancelled after the
  // end.
  absl::Status Push(v1::MeshEvent event);
  // The newest progress replaces one that was not written yet and goes before what is in the ring; never blocks, never
  // fails.
  void SetProgress(const v1::Progress& progress);
  // Blocks until every event was taken by the writer; errors as Push.
  absl::Status Drain();
  // No more events: the call ends with `status`, if OK after what is in the ring, else at once without it.
  void Close(const absl::Status& status);
  // Ends the call at once and wakes whoever waits.
  void Cancel(const absl::Status& status) { Close(status.ok() ? absl::CancelledError("cancelled") : status); }
  void OnWritten(bool ok);

  bool ended() const;
  // Time that Push and Drain stood still.
  absl::Duration stalled() const;
  // The status the call ended, or will end, with; unset while it is open.
  std::optional<absl::Status> final_status() const;

 private:
  void Pump(std::unique_lock<std::mutex>& lock);
  void ActWhilePossible(std::unique_lock<std::mutex>& lock);
  absl::Status WaitFor(std::unique_lock<std::mutex>& lock, size_t most_waiting);

  EventWriter* const writer_;
  const absl::Duration stall_timeout_;
  mutable std::mutex mutex_;
  std::condition_variable taken_;
  std::deque<v1::MeshEvent> ring_;
  std::optional<v1::Progress> progress_;
  std::optional<absl::Status> final_;
  uint64_t taken_count_ = 0;
  bool open_ = false;
  bool pumping_ = false;  // a thread is in Pump: others leave it the work
  bool writing_ = false;  // a write is outstanding
  bool ended_ = false;    // EndCall was, or is being, called
  absl::Duration stalled_;
};

}  // namespace meshfront
