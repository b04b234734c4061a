// A job, step by step: 1 ParseInput (files only), 2 AnnounceDefects (when nothing is to be repaired), 3 the engine
// into the sink, 4 the summary, 5 wait until the reader has everything, 6 close.
#include "server/job.h"

#include <sys/resource.h>

#include <algorithm>

#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "core/base/exceptions.h"
#include "core/base/status_macros.h"
#include "core/prepared_input.h"
#include "proto/wire/convert.h"
#include "proto/wire/crc32c.h"
#include "proto/wire/errors.h"
#include "server/session_result.h"
#include "server/stream_sink.h"
#include "server/version.h"

namespace meshfront {
namespace {

// Progress that comes faster than this is dropped, except where the stage or the prediction changes.
constexpr absl::Duration kProgressInterval = absl::Milliseconds(50);
// When memory ran out, the jobs that hold it need about so long.
constexpr absl::Duration kRetryAfterOutOfMemory = absl::Seconds(5);

uint64_t PeakRssBytes() {
  struct rusage usage {};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<uint64_t>(usage.ru_maxrss) * 1024;
}

struct ParsedInput {
  TriangleMesh mesh;
  std::shared_ptr<const PreparedInput> prepared;  // in its place
  uint64_t revision = 0;                          // of the session that it is of
  std::optional<Region> region;
  Polylines features;
  std::vector<std::string> warnings;
  std::vector<std::string> dropped_attributes;
};

uint64_t AllocatedBytes(const TriangleMesh& mesh) {
  return mesh.positions.capacity() * sizeof(Vec3) + mesh.normals.capacity() * sizeof(Vec3) +
         mesh.triangles.capacity() * sizeof(Triangle) + mesh.attributes.values.capacity() * sizeof(float) +
         mesh.attributes.corners.capacity() * sizeof(CornerWedges) +
         mesh.attributes.groups.capacity() * sizeof(uint32_t);
}

// A file's bytes are held already; what it decompresses to and the mesh in it are held beside them, within what is left.
absl::StatusOr<ParsedInput> ParseFile(const ServiceState& state, PendingBytes::Lease& lease,
                                      const AssembledInput& input) {
  ReadLimits limits;
  limits.max_decompressed_bytes = state.config.limits.max_input_bytes;
  limits.admit = [&, held = lease.held()](uint64_t bytes) { return lease.Hold(held + bytes); };
  MESHFRONT_ASSIGN_OR_RETURN(ReadResult read, ReadMesh(input.file, input.format, input.file_name, limits));
  // Whoever sends a file does not know what the attributes in it are called: they come with arrays only.
  for (const AttributeChannel& channel : read.mesh.attributes.channels)
    read.mesh.dropped_attributes.push_back(channel.name);
  read.mesh.attributes = {};
  MESHFRONT_RETURN_IF_ERROR(lease.Hold(AllocatedBytes(read.mesh)));  // the bytes of the file go with this call's end
  return ParsedInput{std::move(read.mesh), nullptr, 0, std::nullopt, {}, std::move(read.warnings), {}};
}

absl::StatusOr<ParsedInput> ParseInput(ServiceState& state, Job& job) {
  AssembledInput input = std::move(job.input);
  ParsedInput parsed;
  if (!input.session_id.empty()) {
    MESHFRONT_ASSIGN_OR_RETURN(const SessionStore::Kept kept, state.sessions.Find(input.session_id));
    if (input.session_revision) MESHFRONT_RETURN_IF_ERROR(CheckRevision(*input.session_revision, kept.revision));
    parsed.prepared = kept.input;
    parsed.revision = kept.revision;
  } else if (input.file.empty()) {
    parsed.mesh = std::move(input.mesh);
  } else {
    MESHFRONT_ASSIGN_OR_RETURN(parsed, ParseFile(state, job.lease, input));
  }
  parsed.region = std::move(input.region);
  parsed.features = std::move(input.features);
  parsed.dropped_attributes = parsed.mesh.dropped_attributes;
  return parsed;
}

// Tells progress to the call, thinned out.
class ProgressTeller {
 public:
  explicit ProgressTeller(EventStream& events) : events_(events) {}

  void operator()(const Progress& progress) {
    const bool news =
        !told_ || progress.stage != last_.stage || progress.predicted_triangles != last_.predicted_triangles;
    const absl::Time now = absl::Now();
    if (!news && now - told_at_ < kProgressInterval) return;
    told_ = true;
    told_at_ = now;
    last_ = progress;
    events_.SetProgress(ProgressToProto(progress));
  }

 private:
  EventStream& events_;
  bool told_ = false;
  absl::Time told_at_;
  Progress last_;
};

Context ContextOf(const ServiceState& state, const Job& job, absl::Time started) {
  Context context;
  context.stop = &job.stop;
  context.deadline = std::min(job.deadline, started + state.config.max_job);
  context.threads = job.threads;
  context.progress = ProgressTeller(*job.events);
  return context;
}

// With repair off the engine refuses with the first defects; the caller gets a list.
absl::Status AnnounceDefects(const Job& job, const TriangleMesh& mesh) {
  if (job.options.repair || mesh.IsPointSet()) return absl::OkStatus();
  for (const Defect& defect : FindDefects(mesh, kMaxListedDefects).defects) {
    v1::MeshEvent event;
    *event.mutable_defect() = DefectToProto(defect);
    MESHFRONT_RETURN_IF_ERROR(job.events->Push(std::move(event)));
  }
  return absl::OkStatus();
}

// The times that the server measures, beside those of core.
struct JobTimes {
  absl::Time started, parsed, done;
};

void FillSeconds(const Job& job, const JobTimes& times, v1::Seconds& seconds) {
  seconds.set_upload(absl::ToDoubleSeconds(job.upload_end - job.upload_begin));
  seconds.set_queued(absl::ToDoubleSeconds(times.started - job.upload_end));
  seconds.set_read(absl::ToDoubleSeconds(times.parsed - times.started));
  seconds.set_engine(absl::ToDoubleSeconds(times.done - times.parsed));
}

template <class Message>
void FillCommon(const ParsedInput& input, Message& message) {
  message.set_version(kVersion);
  for (const std::string& name : input.dropped_attributes) message.add_dropped_attributes(name);
  for (const std::string& warning : input.warnings) message.add_warnings(warning);
}

void FillSummary(const Job& job, const JobTimes& times, const StreamSink& sink, v1::Summary& summary) {
  FillSeconds(job, times, *summary.mutable_seconds());
  if (sink.first_triangle()) {
    summary.mutable_seconds()->set_first_chunk(absl::ToDoubleSeconds(*sink.first_triangle() - job.upload_end));
  }
  summary.mutable_seconds()->set_stalled(absl::ToDoubleSeconds(job.events->stalled()));
  summary.set_chunks(sink.builder().chunks());
  summary.set_chunks_crc32c(sink.builder().chunks_crc32c());
  summary.set_server_peak_rss_bytes(PeakRssBytes());
}

absl::Status SendRemovedFaces(const Job& job, const std::vector<uint32_t>& faces) {
  const size_t most = job.output.chunk_bytes() / sizeof(uint32_t);
  for (size_t begin = 0; begin < faces.size(); begin += most) {
    v1::MeshEvent event;
    v1::RemovedFaces& removed = *event.mutable_removed();
    removed.set_faces(faces.data() + begin, sizeof(uint32_t) * std::min(most, faces.size() - begin));
    removed.set_crc32c(Crc32c(removed.faces()));
    MESHFRONT_RETURN_IF_ERROR(job.events->Push(std::move(event)));
  }
  return absl::OkStatus();
}

// The end of a mesh: what is left of it, and its summary.
absl::Status FinishMesh(Job& job, const ParsedInput& input, const JobTimes& times, StreamSink& sink,
                        const Report& report, uint32_t level) {
  MESHFRONT_RETURN_IF_ERROR(sink.Flush());
  if (report.region) MESHFRONT_RETURN_IF_ERROR(SendRemovedFaces(job, report.region->removed_faces));
  job.summary = SummaryFromReport(report);
  job.summary.set_level(level);
  FillCommon(input, job.summary);
  FillSummary(job, times, sink, job.summary);
  return absl::OkStatus();
}

// The commit mark, where it is the last.
absl::Status SendSummary(Job& job) {
  v1::MeshEvent event;
  *event.mutable_summary() = job.summary;
  return job.events->Push(std::move(event));
}

using SharedInput = std::shared_ptr<const PreparedInput>;

// The result as what is kept, with the attributes that it was given; ResourceExhausted where it is too large for that.
absl::StatusOr<SharedInput> PrepareResult(const Job& job, SessionResult& result, const PreparedInput& input,
                                          const Context& context) {
  MESHFRONT_RETURN_IF_ERROR(result.status());
  TriangleMesh mesh = result.Take();
  if (!mesh.attributes.corners.empty()) mesh.attributes.channels = input.mesh().attributes.channels;
  return PreparedInput::Create(std::move(mesh), job.options.repair, context);
}

void TellSession(const ServiceState& state, Job& job, const std::string& name, const SessionStore::Kept& kept) {
  v1::Session& session = *job.summary.mutable_session();
  session.set_id(name);
  session.set_ttl_seconds(absl::ToDoubleSeconds(state.sessions.ttl()));
  session.set_bytes(kept.input->bytes());
  session.set_revision(kept.revision);
}

// Opens a session of the input or the result. Where there is none that the server can keep a warning says so.
absl::Status OpenSession(ServiceState& state, Job& job, const absl::StatusOr<SharedInput>& mesh) {
  const absl::StatusOr<std::string> name = mesh.ok() ? state.sessions.Keep(*mesh) : mesh.status();
  if (absl::IsResourceExhausted(name.status()) && !IsOutOfMemory(name.status())) {
    job.summary.add_warnings(absl::StrCat("no session is kept: ", name.status().message()));
    return absl::OkStatus();
  }
  if (!name.ok()) return name.status();
  TellSession(state, job, *name, {*mesh, 0});
  return absl::OkStatus();
}

// Puts the result in the place of the session's mesh. Where it is too large the session stays as it is, and the summary says so: what was
// sent is a result all the same.
absl::Status UpdateSession(ServiceState& state, Job& job, const std::string& id, const ParsedInput& input,
                           const absl::StatusOr<SharedInput>& result) {
  absl::Status refusal = result.status();
  if (result.ok()) {
    const absl::StatusOr<uint64_t> revision = state.sessions.Replace(id, input.revision, *result);
    if (revision.ok()) {
      TellSession(state, job, id, {*result, *revision});
      return absl::OkStatus();
    }
    refusal = revision.status();
  }
  if (ReasonOf(refusal).reason != kSessionTooLarge) return refusal;
  job.summary.add_warnings(absl::StrCat("the session's mesh is not replaced, and stays at revision ", input.revision,
                                        ": ", refusal.message()));
  TellSession(state, job, id, {input.prepared, input.revision});
  job.summary.mutable_session()->set_update_refusal(kSessionTooLarge);
  return absl::OkStatus();
}

// Says in the summary what is kept, the input or the result, or in a warning why nothing is.
absl::Status KeepSession(ServiceState& state, Job& job, const std::string& id, const ParsedInput& input,
                         SessionResult& result, const Context& context) {
  if (id.empty() && !job.keeps_session) return absl::OkStatus();
  if (job.updates_session) {
    absl::StatusOr<SharedInput> made = PrepareResult(job, result, *input.prepared, context);
    return id.empty() ? OpenSession(state, job, made) : UpdateSession(state, job, id, input, made);
  }
  if (id.empty()) return OpenSession(state, job, input.prepared);
  TellSession(state, job, id, {input.prepared, input.revision});
  return absl::OkStatus();
}

// What is sure to be too large for the session that it is to replace is refused before the work; where a session is to be opened, none is.
auto AdmissionTo(const std::string& session_id, SessionResult& result) {
  return [&result, opens = session_id.empty()](uint64_t triangles) {
    absl::Status fits = result.CheckPrediction(triangles);
    if (fits.ok() || !opens) return fits;
    result.Refuse(std::move(fits));
    return absl::OkStatus();
  };
}

// Streams one level after the other, each with its own chunks and summary.
class LevelStream : public LevelSink {
 public:
  // `times`: of the first level, `done` open. All outlive it.
  LevelStream(Job& job, const ParsedInput& input, JobTimes times) : job_(job), input_(input), times_(times) {}

  MeshSink& BeginLevel() override { return sink_.emplace(*job_.events, job_.output); }
  absl::Status EndLevel(const Report& report) override {
    times_.done = absl::Now();
    MESHFRONT_RETURN_IF_ERROR(FinishMesh(job_, input_, times_, *sink_, report, level_++));
    MESHFRONT_RETURN_IF_ERROR(SendSummary(job_));
    times_.parsed = absl::Now();
    return absl::OkStatus();
  }

 private:
  Job& job_;
  const ParsedInput& input_;
  JobTimes times_;
  std::optional<StreamSink> sink_;
  uint32_t level_ = 0;
};

absl::Status RemeshBody(ServiceState& state, Job& job) {
  JobTimes times;
  times.started = absl::Now();
  const std::string session_id = job.input.session_id;
  MESHFRONT_ASSIGN_OR_RETURN(ParsedInput input, ParseInput(state, job));
  times.parsed = absl::Now();
  const Context context = ContextOf(state, job, times.started);
  MESHFRONT_RETURN_IF_ERROR(context.CheckStop());
  MESHFRONT_RETURN_IF_ERROR(AnnounceDefects(job, input.mesh));
  if (job.keeps_session && !input.prepared) {
    MESHFRONT_ASSIGN_OR_RETURN(input.prepared,
                               PreparedInput::Create(std::move(input.mesh), job.options.repair, context));
  }
  SessionResult result(state.sessions);
  Problem problem{std::move(input.mesh), job.options, std::move(input.region), input.prepared,
                  std::move(input.features)};
  if (job.updates_session) {
    problem.whole = &result;
    if (problem.region) result.ReserveLike(input.prepared->mesh());
    problem.admit = AdmissionTo(session_id, result);
  }
  if (!job.options.lod_rhos.empty()) {
    LevelStream levels(job, input, times);
    MESHFRONT_RETURN_IF_ERROR(state.engine.remesh_levels(std::move(problem), levels, context));
    return job.events->Drain();
  }
  StreamSink sink(*job.events, job.output);
  MESHFRONT_ASSIGN_OR_RETURN(const Report report, state.engine.remesh(std::move(problem), sink, context));
  times.done = absl::Now();
  MESHFRONT_RETURN_IF_ERROR(FinishMesh(job, input, times, sink, report, 0));
  MESHFRONT_RETURN_IF_ERROR(KeepSession(state, job, session_id, input, result, context));
  MESHFRONT_RETURN_IF_ERROR(SendSummary(job));
  return job.events->Drain();
}

absl::Status EstimateBody(ServiceState& state, Job& job) {
  JobTimes times;
  times.started = absl::Now();
  MESHFRONT_ASSIGN_OR_RETURN(ParsedInput input, ParseInput(state, job));
  times.parsed = absl::Now();
  Context context = ContextOf(state, job, times.started);
  context.progress = nullptr;
  MESHFRONT_RETURN_IF_ERROR(context.CheckStop());
  MESHFRONT_ASSIGN_OR_RETURN(const Estimate estimate,
                             state.engine.estimate({std::move(input.mesh), job.options, std::move(input.region),
                                                    input.prepared, std::move(input.features)},
                                                   context));
  times.done = absl::Now();
  job.estimate = EstimateToProto(estimate);
  FillCommon(input, job.estimate);
  FillSeconds(job, times, *job.estimate.mutable_seconds());
  return absl::OkStatus();
}

// The server's own limit on a job's time told from the caller's deadline.
absl::Status WithTimeLimit(const ServiceState& state, const Job& job, absl::Status status) {
  if (!absl::IsDeadlineExceeded(status) || absl::Now() >= job.deadline) return status;
  const std::string limit = absl::FormatDuration(state.config.max_job);
  return WithReason(
      absl::DeadlineExceededError(absl::StrCat("the job took longer than ", limit, ", which this server allows a job")),
      "JOB_TIME_LIMIT", {{"limit", limit}});
}

// Closes the events whatever happens.
void End(ServiceState& state, Job& job, const absl::Status& status) noexcept {
  absl::Status final(status.code(), "");  // needs no memory
  try {
    // An error overtakes what is in the ring; here that would be the list of defects.
    if (absl::IsFailedPrecondition(status)) (void)job.events->Drain();
    final = Presentable(state, job.id, WithTimeLimit(state, job, status));
  } catch (...) {
  }
  try {
    job.events->Close(final);
  } catch (...) {
  }
}

template <class Body>
void RunGuarded(ServiceState& state, Job& job, Body body) {
  absl::Status status;
  try {
    status = body(state, job);
  } catch (...) {
    status = StatusOfException();
  }
  End(state, job, status);
}

}  // namespace

absl::Status Presentable(ServiceState& state, const std::string& job_id, const absl::Status& status) {
  const auto log_fault = [&] { state.log->Write({{"fault", status.ToString()}, {"job", job_id}}); };
  if (IsOutOfMemory(status)) {
    log_fault();
    return WithRetry(WithReason(status, "OUT_OF_MEMORY", {{"job_id", job_id}}), kRetryAfterOutOfMemory);
  }
  switch (status.code()) {
    case absl::StatusCode::kOk:
    case absl::StatusCode::kInvalidArgument:
    case absl::StatusCode::kFailedPrecondition:
    case absl::StatusCode::kNotFound:
    case absl::StatusCode::kResourceExhausted:
    case absl::StatusCode::kUnavailable:
    case absl::StatusCode::kUnimplemented:
    case absl::StatusCode::kDataLoss:
    case absl::StatusCode::kAborted:
    case absl::StatusCode::kCancelled:
    case absl::StatusCode::kDeadlineExceeded:
      return status;
    default:
      break;
  }
  log_fault();
  return WithReason(absl::InternalError(absl::StrCat("internal error in job ", job_id, "; the server's log says more")),
                    "INTERNAL", {{"job_id", job_id}});
}

void RunRemesh(ServiceState& state, Job& job) { RunGuarded(state, job, RemeshBody); }
void RunEstimate(ServiceState& state, Job& job) { RunGuarded(state, job, EstimateBody); }

}  // namespace meshfront
