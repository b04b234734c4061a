#include "client/remesh_client.h"

#include <grpcpp/create_channel.h>
#include <grpcpp/security/credentials.h>

#include <algorithm>
#include <cstring>

#include "absl/strings/str_cat.h"
#include "client/mesh_upload.h"
#include "core/base/status_macros.h"
#include "proto/wire/crc32c.h"
#include "proto/wire/errors.h"

namespace meshfront {
namespace {

// A chunk is at most 1 MiB by contract, a Summary some dozen KiB; a server beyond this is not ours.
constexpr int kMaxMessageBytes = 8 << 20;

// Hangs the canceller onto a call for as long as it runs.
class ScopedCall {
 public:
  ScopedCall(const CallOptions& call, const std::function<bool(grpc::ClientContext*)>& attach,
             std::function<void()> detach)
      : detach_(std::move(detach)) {
    if (call.deadline != absl::InfiniteFuture()) context_.set_deadline(absl::ToChronoTime(call.deadline));
    if (!attach(&context_)) context_.TryCancel();
  }
  ~ScopedCall() { detach_(); }
  grpc::ClientContext* context() { return &context_; }

 private:
  grpc::ClientContext context_;
  std::function<void()> detach_;
};

// Header, blocks, end. False when the stream broke; its status says why.
template <class Request, class Stream>
bool SendInput(const TriangleMesh& mesh, const CallOptions& call, Stream* stream) {
  Request request;
  *request.mutable_header() = HeaderFor(mesh);
  *request.mutable_header()->mutable_options() = call.options;
  *request.mutable_header()->mutable_output() = call.output;
  request.mutable_header()->set_keep_session(call.keep_session);
  request.mutable_header()->set_update_session(call.update_session);
  if (call.session_revision) request.mutable_header()->set_session_revision(*call.session_revision);
  if (!call.session_id.empty()) request.mutable_header()->set_session_id(call.session_id);
  if (!call.region_faces.empty())
    request.mutable_header()->mutable_options()->mutable_region()->set_face_count(call.region_faces.size());
  if (!call.features.segments.empty()) {
    v1::FeatureCurves* curves = request.mutable_header()->mutable_options()->mutable_features();
    curves->set_point_count(call.features.points.size());
    curves->set_segment_count(call.features.segments.size());
  }
  if (!stream->Write(request)) return false;
  v1::EndOfInput end;
  const auto write = [&](const v1::DataBlock& block) {
    *request.mutable_block() = block;
    return stream->Write(request);
  };
  if (!UploadArrays(mesh, call.region_faces, call.features, write, &end)) return false;
  *request.mutable_end() = end;
  return stream->Write(request) && stream->WritesDone();
}

// Takes the events of one response stream to the observer and remembers the Summary.
class EventReader {
 public:
  // `levels`: as many meshes come, each with its Summary.
  EventReader(v1::ScalarType scalar_type, size_t levels, RemeshObserver& observer)
      : scalar_type_(scalar_type), levels_(levels), decoder_(scalar_type), observer_(observer) {}

  absl::Status Take(const v1::MeshEvent& event) {
    if (summaries_.size() == levels_) return absl::DataLossError("the server sent more after its Summary");
    switch (event.event_case()) {
      case v1::MeshEvent::kAccepted:
        observer_.OnAccepted(event.accepted());
        break;
      case v1::MeshEvent::kProgress:
        observer_.OnProgress(event.progress());
        break;
      case v1::MeshEvent::kDefect:
        observer_.OnDefect(event.defect());
        break;
      case v1::MeshEvent::kChunk:
        MESHFRONT_RETURN_IF_ERROR(decoder_.Decode(event.chunk()));
        return observer_.OnChunk(event.chunk(), decoder_);
      case v1::MeshEvent::kRemoved:
        return TakeRemoved(event.removed());
      case v1::MeshEvent::kSummary:
        return TakeSummary(event.summary());
      default:
        break;  // an event of a later version
    }
    return absl::OkStatus();
  }

  absl::StatusOr<std::vector<v1::Summary>> Result() && {
    if (summaries_.size() < levels_) {
      return absl::DataLossError(levels_ == 1 ? "the result ended without a Summary"
                                              : absl::StrCat("the result ended with ", summaries_.size(),
                                                             " Summaries; there are ", levels_, " levels"));
    }
    return std::move(summaries_);
  }

 private:
  absl::Status TakeRemoved(const v1::RemovedFaces& removed) {
    if (Crc32c(removed.faces()) != removed.crc32c() || removed.faces().size() % sizeof(uint32_t) != 0)
      return absl::DataLossError("a list of removed faces is damaged; its checksum differs");
    std::vector<uint32_t> faces(removed.faces().size() / sizeof(uint32_t));
    std::memcpy(faces.data(), removed.faces().data(), removed.faces().size());
    removed_faces_ += faces.size();
    observer_.OnRemovedFaces(faces);
    return absl::OkStatus();
  }

  absl::Status TakeSummary(const v1::Summary& summary) {
    if (summary.region().removed_faces() != removed_faces_) {
      return absl::DataLossError(absl::StrCat("the Summary tells of ", summary.region().removed_faces(),
                                              " removed faces; ", removed_faces_, " came"));
    }
    if (summary.chunks() != decoder_.chunk_count() || summary.chunks_crc32c() != decoder_.chunks_crc32c()) {
      return absl::DataLossError(absl::StrCat("the Summary tells of ", summary.chunks(),
                                              " chunks with another checksum; ", decoder_.chunk_count(), " came"));
    }
    if (summary.level() != summaries_.size()) {
      return absl::DataLossError(
          absl::StrCat("a Summary is of level ", summary.level(), "; it must be of level ", summaries_.size()));
    }
    summaries_.push_back(summary);
    if (summaries_.size() == levels_) return absl::OkStatus();
    decoder_ = ChunkDecoder(scalar_type_);
    observer_.OnLevelEnd(summary);
    return absl::OkStatus();
  }

  const v1::ScalarType scalar_type_;
  const size_t levels_;
  ChunkDecoder decoder_;
  RemeshObserver& observer_;
  std::vector<v1::Summary> summaries_;
  uint64_t removed_faces_ = 0;
};

}  // namespace

void CallCanceller::Cancel() {
  const std::lock_guard<std::mutex> lock(mutex_);
  cancelled_ = true;
  if (context_ != nullptr) context_->TryCancel();
}

bool CallCanceller::Attach(grpc::ClientContext* context) {
  const std::lock_guard<std::mutex> lock(mutex_);
  context_ = context;
  return !cancelled_;
}

void CallCanceller::Detach() {
  const std::lock_guard<std::mutex> lock(mutex_);
  context_ = nullptr;
}

std::shared_ptr<grpc::Channel> CreateRemoteChannel(const std::string& address) {
  grpc::ChannelArguments arguments;
  arguments.SetMaxReceiveMessageSize(kMaxMessageBytes);
  return grpc::CreateCustomChannel(address, grpc::InsecureChannelCredentials(), arguments);
}

RemeshClient::RemeshClient(const std::shared_ptr<grpc::ChannelInterface>& channel)
    : stub_(v1::MeshfrontService::NewStub(channel)) {}

absl::StatusOr<v1::Summary> RemeshClient::Remesh(TriangleMesh mesh, const CallOptions& call, RemeshObserver& observer) {
  if (call.options.lod_rhos_size() > 1)
    return absl::InvalidArgumentError("options.lod_rhos has several values; RemeshLevels takes them");
  MESHFRONT_ASSIGN_OR_RETURN(const std::vector<v1::Summary> summaries, RemeshLevels(std::move(mesh), call, observer));
  return summaries.front();
}

absl::StatusOr<std::vector<v1::Summary>> RemeshClient::RemeshLevels(TriangleMesh mesh, const CallOptions& call,
                                                                    RemeshObserver& observer) {
  ScopedCall scope(
      call, [&](grpc::ClientContext* c) { return call.canceller == nullptr || call.canceller->Attach(c); },
      [&] {
        if (call.canceller != nullptr) call.canceller->Detach();
      });
  const auto stream = stub_->Remesh(scope.context());
  if (SendInput<v1::RemeshRequest>(mesh, call, stream.get())) observer.OnUploaded();
  mesh = TriangleMesh();

  const v1::ScalarType type =
      call.output.scalar_type() == v1::SCALAR_TYPE_UNSPECIFIED ? v1::SCALAR_TYPE_FLOAT32 : call.output.scalar_type();
  EventReader reader(type, std::max(call.options.lod_rhos_size(), 1), observer);
  v1::RemeshResponse response;
  absl::Status taken;
  while (taken.ok() && stream->Read(&response)) taken = reader.Take(response.event());
  if (!taken.ok()) scope.context()->TryCancel();
  const grpc::Status status = stream->Finish();
  if (!taken.ok()) return taken;
  if (!status.ok()) return FromGrpcStatus(status);
  return std::move(reader).Result();
}

absl::StatusOr<v1::EstimateResponse> RemeshClient::Estimate(TriangleMesh mesh, const CallOptions& call) {
  ScopedCall scope(
      call, [&](grpc::ClientContext* c) { return call.canceller == nullptr || call.canceller->Attach(c); },
      [&] {
        if (call.canceller != nullptr) call.canceller->Detach();
      });
  v1::EstimateResponse response;
  const auto stream = stub_->Estimate(scope.context(), &response);
  SendInput<v1::EstimateRequest>(mesh, call, stream.get());
  mesh = TriangleMesh();
  const grpc::Status status = stream->Finish();
  if (!status.ok()) return FromGrpcStatus(status);
  return response;
}

absl::StatusOr<v1::GetCapabilitiesResponse> RemeshClient::GetCapabilities(absl::Time deadline) {
  grpc::ClientContext context;
  if (deadline != absl::InfiniteFuture()) context.set_deadline(absl::ToChronoTime(deadline));
  v1::GetCapabilitiesResponse response;
  const grpc::Status status = stub_->GetCapabilities(&context, {}, &response);
  if (!status.ok()) return FromGrpcStatus(status);
  return response;
}

}  // namespace meshfront
