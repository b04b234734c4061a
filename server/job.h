// One job: an upload that is whole, run on a worker.
#pragma once

#include <atomic>
#include <memory>
#include <string>

#include "absl/time/time.h"
#include "meshfront/v1/remesh_service.pb.h"
#include "server/event_stream.h"
#include "server/input_assembler.h"
#include "server/pending_bytes.h"
#include "server/service_state.h"

namespace meshfront {

// Shared by its call and its worker; outlives the call when the client leaves.
struct Job {
  Job(PendingBytes& pending, std::shared_ptr<EventStream> events) : events(std::move(events)), lease(pending) {}

  std::string id;
  AssembledInput input;  // taken by the worker
  RemeshOptions options;
  v1::OutputFormat output;
  int threads = 1;
  bool keeps_session = false, updates_session = false;
  absl::Time deadline = absl::InfiniteFuture();
  absl::Time upload_begin, upload_end;
  std::atomic<bool> stop{false};
  const std::shared_ptr<EventStream> events;
  PendingBytes::Lease lease;

  // Written by the worker before it closes the events, read by the call after.
  v1::Summary summary;
  v1::EstimateResponse estimate;
};

// What may leave the server: of a fault, the job's id and nothing of the inside, which goes to the log; that memory ran out,
// with a time to wait.
absl::Status Presentable(ServiceState& state, const std::string& job_id, const absl::Status& status);

// Run the job and close its events; nothing escapes. A fault of any kind ends this job with Internal and its id, and
// the log has what it was; memory that runs out, with ResourceExhausted.
void RunRemesh(ServiceState& state, Job& job);
void RunEstimate(ServiceState& state, Job& job);

}  // namespace meshfront
