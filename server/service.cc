#include "server/service.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "core/base/status_macros.h"
#include "proto/wire/convert.h"
#include "server/reactors.h"
#include "server/version.h"

namespace meshfront {

std::string ServiceState::NewJobId() {
  static const int64_t start = absl::ToUnixMillis(absl::Now());
  return absl::StrCat("j-", absl::Hex(start), "-", ++jobs_);
}

Metrics::Levels ServiceState::CurrentLevels() {
  const WorkerPool::Load load = pool.load();
  const SessionStore::Usage kept = sessions.usage();
  return {static_cast<uint64_t>(gate.inside()), load.running, load.queued, kept.sessions, kept.bytes};
}

absl::StatusOr<std::unique_ptr<Service>> Service::Create(const ServerConfig& config, Engine engine) {
  MESHFRONT_ASSIGN_OR_RETURN(std::unique_ptr<JobLog> log, JobLog::Create(config.log));
  return std::unique_ptr<Service>(new Service(config, std::move(engine), std::move(log)));
}

grpc::ServerBidiReactor<v1::RemeshRequest, v1::RemeshResponse>* Service::Remesh(grpc::CallbackServerContext* context) {
  return new RemeshReactor(state_, *context);
}

grpc::ServerReadReactor<v1::EstimateRequest>* Service::Estimate(grpc::CallbackServerContext* context,
                                                                v1::EstimateResponse* response) {
  return new EstimateReactor(state_, *context, response);
}

grpc::ServerUnaryReactor* Service::GetCapabilities(grpc::CallbackServerContext* context,
                                                   const v1::GetCapabilitiesRequest*,
                                                   v1::GetCapabilitiesResponse* response) {
  *response = CapabilitiesOf(state_.config);
  grpc::ServerUnaryReactor* reactor = context->DefaultReactor();
  reactor->Finish(grpc::Status::OK);
  return reactor;
}

v1::GetCapabilitiesResponse CapabilitiesOf(const ServerConfig& config) {
  v1::GetCapabilitiesResponse response;
  response.set_version(kVersion);
  for (int format = v1::FILE_FORMAT_OFF; format <= v1::FILE_FORMAT_XYZ; ++format) {
    response.add_file_formats(static_cast<v1::FileFormat>(format));
  }
  v1::Limits& limits = *response.mutable_limits();
  limits.set_max_input_bytes(config.limits.max_input_bytes);
  limits.set_max_vertices(config.limits.max_vertices);
  limits.set_max_triangles(config.limits.max_triangles);
  limits.set_max_block_bytes(kMaxBlockBytes);
  limits.set_min_chunk_bytes(kMinChunkBytes);
  limits.set_default_chunk_bytes(kDefaultChunkBytes);
  limits.set_max_chunk_bytes(kMaxChunkBytes);
  limits.set_max_threads(config.MaxThreads());
  limits.set_workers(config.Workers());
  limits.set_max_queue(config.max_queue);
  limits.set_stall_timeout_seconds(absl::ToDoubleSeconds(config.stall_timeout));
  if (config.max_job < absl::InfiniteDuration()) limits.set_max_job_seconds(absl::ToDoubleSeconds(config.max_job));
  limits.set_max_sessions(config.sessions.max_count);
  limits.set_max_session_bytes(config.sessions.max_bytes);
  limits.set_session_ttl_seconds(absl::ToDoubleSeconds(config.sessions.ttl));
  *response.mutable_default_options() = OptionsToProto(RemeshOptions());
  for (std::string& path : SupportedOptions()) response.add_supported_options(std::move(path));
  response.add_supported_inputs("mesh");
  response.add_supported_inputs("file");
  response.add_supported_inputs("session_id");
  return response;
}

}  // namespace meshfront
