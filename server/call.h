// One call, without the types of its rpc: the upload, the job, the end. The reactors hand on what gRPC tells them.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>

#include "absl/status/status.h"
#include "absl/time/clock.h"
#include "server/input_assembler.h"
#include "server/job.h"
#include "server/service_state.h"

namespace meshfront {

// Messages come one at a time; OnCancel may come at any time, from any thread.
class Call {
 public:
  struct Peer {
    std::string rpc;      // for the log
    std::string address;  // for the log
    absl::Time deadline = absl::InfiniteFuture();
  };
  using Run = void (*)(ServiceState&, Job&);

  // `writer` is the reactor that owns this call. `run` runs the job.
  Call(ServiceState& state, Peer peer, EventWriter* writer, Run run);
  ~Call();

  // Lets the call in, or ends it. True: read.
  bool Begin();
  // Takes a message. True: read the next one, also after the end, where none may come. What throws here ends the call, not
  // the server.
  template <class Request>
  bool OnMessage(const Request& request) {
    try {
      return submitted_ ? RefuseMore(assembler_.AcceptMessage(request)) : AfterMessage(Assemble(request));
    } catch (...) {
      if (!submitted_) (void)assembler_.Take();  // what was uploaded: its memory lets the rest of this succeed
      OnFault();
      return false;
    }
  }
  // Ends the call with what the exception that is being handled means. Never throws: in a catch block only.
  void OnFault() noexcept;
  // Whether the input is whole: no message has a place any more.
  bool submitted() const { return submitted_; }
  // The client said no more before the input was whole.
  void OnInputCut();
  void OnCancel();
  void OnWritten(bool ok) { events_->OnWritten(ok); }
  // The writer's EndCall calls this: releases what the call holds and writes the log line.
  void OnEnded(const absl::Status& status) noexcept;

  const Job& job() const { return *job_; }

 private:
  template <class Request>
  absl::Status Assemble(const Request& request) {
    const bool had_header = assembler_.has_header();
    absl::Status status = job_->lease.Hold(assembler_.BytesToAccept(request));
    if (!status.ok()) return status;
    status = assembler_.AcceptMessage(request);
    NoteForLog();
    if (!status.ok()) return status;
    if (!had_header) return state_.pool.CheckRoom();
    return job_->lease.Hold(assembler_.allocated_bytes());
  }
  // What the log line says of the upload: the call may end on another thread than the one that reads.
  void NoteForLog();
  bool AfterMessage(const absl::Status& status);
  bool RefuseMore(const absl::Status& status);
  void Submit();
  void WriteLogLine(const absl::Status& status);
  v1::MeshEvent AcceptedEvent(uint32_t position, const Box3& bounds) const;
  absl::Status CancelStatus() const;

  ServiceState& state_;
  const Peer peer_;
  const Run run_;
  const std::shared_ptr<EventStream> events_;
  const std::shared_ptr<Job> job_;
  InputAssembler assembler_;
  bool submitted_ = false;  // as the assembler, of the thread that reads
  std::mutex noted_mutex_;
  std::string noted_request_id_;
  uint64_t noted_bytes_ = 0;
  bool noted_session_ = false;  // the input is a session's
  std::atomic<bool> entered_{false};
  std::atomic<uint64_t> watch_id_{0};
  std::atomic<uint64_t> ticket_{0};
};

}  // namespace meshfront
