#include "server/call.h"

#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/exceptions.h"
#include "proto/wire/convert.h"
#include "proto/wire/errors.h"

namespace meshfront {

Call::Call(ServiceState& state, Peer peer, EventWriter* writer, Run run)
    : state_(state),
      peer_(std::move(peer)),
      run_(run),
      events_(std::make_shared<EventStream>(writer, state.config.stall_timeout)),
      job_(std::make_shared<Job>(state.pending, events_)),
      assembler_(state.config.limits) {
  job_->id = state.NewJobId();
  job_->deadline = peer_.deadline;
  job_->upload_begin = absl::Now();
}

Call::~Call() {
  // Only where what should have begun the call threw: otherwise it has ended and left.
  if (entered_) state_.watch.Remove(watch_id_);
  if (entered_.exchange(false)) state_.gate.Leave();
}

bool Call::Begin() {
  if (absl::Status status = state_.gate.Enter(); !status.ok()) {
    events_->Close(status);
    return false;
  }
  entered_ = true;
  watch_id_ = state_.watch.Add(events_);
  return true;
}

void Call::NoteForLog() {
  std::lock_guard lock(noted_mutex_);
  if (noted_request_id_.empty()) noted_request_id_ = assembler_.request_id();
  noted_bytes_ = assembler_.bytes();
  noted_session_ = assembler_.names_session();
}

bool Call::AfterMessage(const absl::Status& status) {
  if (!status.ok()) {
    events_->Close(status);
    return false;
  }
  if (!assembler_.whole()) {
    state_.watch.Touch(watch_id_);
    return !events_->ended();
  }
  Submit();
  submitted_ = true;
  return !events_->ended();
}

bool Call::RefuseMore(const absl::Status& status) {
  if (const uint64_t ticket = ticket_; ticket != 0) state_.pool.Remove(ticket);
  events_->Close(status);
  return false;
}

void Call::OnFault() noexcept {
  absl::Status status(absl::StatusCode::kResourceExhausted, "");  // needs no memory
  try {
    status = Presentable(state_, job_->id, StatusOfException());
  } catch (...) {
  }
  try {
    events_->Close(status);
  } catch (...) {
  }
}

void Call::OnInputCut() {
  if (submitted_) return;
  events_->Close(absl::InvalidArgumentError(assembler_.has_header()
                                                ? "end is missing; the stream was closed before the input was whole"
                                                : "header is missing; the stream was closed before it"));
}

void Call::Submit() {
  state_.watch.Remove(watch_id_);
  const int most = state_.config.MaxThreads();
  const uint32_t asked = assembler_.requested_threads();
  job_->upload_end = absl::Now();
  job_->threads = asked == 0 ? most : static_cast<int>(std::min<uint32_t>(asked, most));
  job_->options = assembler_.options();
  job_->output = assembler_.output();
  job_->keeps_session = assembler_.keeps_session();
  job_->updates_session = assembler_.updates_session();
  job_->input = assembler_.Take();
  Box3 bounds;
  for (const Vec3& p : job_->input.mesh.positions) {
    if (IsFinite(p)) bounds.Extend(p);
  }
  absl::StatusOr<WorkerPool::Ticket> ticket =
      state_.pool.Submit([state = &state_, job = job_, run = run_] { run(*state, *job); });
  if (!ticket.ok()) return events_->Close(ticket.status());
  ticket_ = ticket->id;
  // Cancelled between the last message and now: OnCancel did not know the ticket.
  if (job_->stop) state_.pool.Remove(ticket->id);
  events_->Open(AcceptedEvent(ticket->position, bounds));
}

v1::MeshEvent Call::AcceptedEvent(uint32_t position, const Box3& bounds) const {
  v1::MeshEvent event;
  v1::Accepted& accepted = *event.mutable_accepted();
  accepted.set_job_id(job_->id);
  accepted.set_request_id(assembler_.request_id());
  accepted.set_queue_position(position);
  if (!bounds.empty()) {  // a file is parsed by the worker
    *accepted.mutable_bounds()->mutable_min() = PointToProto(bounds.min);
    *accepted.mutable_bounds()->mutable_max() = PointToProto(bounds.max);
  }
  *accepted.mutable_output() = assembler_.output();
  return event;
}

absl::Status Call::CancelStatus() const {
  if (absl::Now() >= peer_.deadline) return absl::DeadlineExceededError("the deadline passed before the job was done");
  return absl::CancelledError("the client cancelled the call");
}

void Call::OnCancel() {
  job_->stop = true;
  try {
    if (const uint64_t ticket = ticket_; ticket != 0) state_.pool.Remove(ticket);
    events_->Cancel(CancelStatus());
  } catch (...) {
    OnFault();
  }
}

void Call::OnEnded(const absl::Status& status) noexcept {
  job_->stop = true;  // whatever ended the call, nobody waits for the job any more
  state_.watch.Remove(watch_id_);
  try {
    WriteLogLine(status);
  } catch (...) {  // without memory for the line the call must end all the same
  }
  if (entered_.exchange(false)) state_.gate.Leave();
}

void Call::WriteLogLine(const absl::Status& status) {
  const v1::Summary& summary = job_->summary;
  const bool done = status.ok();
  const SessionStore::Usage sessions = state_.sessions.usage();
  const double seconds = absl::ToDoubleSeconds(absl::Now() - job_->upload_begin);
  std::lock_guard lock(noted_mutex_);
  state_.metrics.Note({peer_.rpc, status.code(), seconds, noted_bytes_, done ? summary.output().triangles() : 0});
  if (done && summary.has_seconds()) state_.metrics.Note(summary.seconds());
  state_.log->Write({{"time", absl::FormatTime(absl::RFC3339_full, absl::Now(), absl::UTCTimeZone())},
                     {"rpc", peer_.rpc},
                     {"job", job_->id},
                     {"request_id", noted_request_id_},
                     {"peer", peer_.address},
                     {"code", absl::StatusCodeToString(status.code())},
                     {"message", std::string(status.message())},
                     {"input_bytes", noted_bytes_},
                     {"triangles", done ? summary.output().triangles() : 0},
                     {"chunks", done ? summary.chunks() : 0},
                     {"engine_seconds", done ? summary.seconds().engine() : 0},
                     {"session", noted_session_                  ? "used"
                                 : done && summary.has_session() ? "kept"
                                                                 : ""},
                     {"sessions", sessions.sessions},
                     {"session_bytes", sessions.bytes},
                     {"seconds", seconds}});
}

}  // namespace meshfront
