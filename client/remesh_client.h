// The client library: calls of meshfront.v1.MeshfrontService over any channel.
#pragma once

#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "absl/types/span.h"
#include "client/chunk_decoder.h"
#include "core/mesh/polylines.h"
#include "core/mesh/triangle_mesh.h"
#include "meshfront/v1/remesh_service.grpc.pb.h"

namespace meshfront {

// Cancels a call from another thread, before, while or after it runs. Thread-safe; one per call.
class CallCanceller {
 public:
  void Cancel();

 private:
  friend class RemeshClient;
  bool Attach(grpc::ClientContext* context);  // false: cancelled before it began
  void Detach();

  std::mutex mutex_;
  grpc::ClientContext* context_ = nullptr;
  bool cancelled_ = false;
};

struct CallOptions {
  v1::RemeshOptions options;
  std::vector<uint32_t>
      region_faces;    // where they are the region: 0-based input order; announced in the options for you
  Polylines features;  // lines to keep, announced likewise; empty: none
  v1::OutputFormat output;
  std::string session_id;     // of an earlier call's Summary: its mesh, in place of the one given, which must be empty
  bool keep_session = false;  // the server keeps the mesh; Summary.session names it
  bool update_session = false;               // with either of them: the result takes that mesh's place
  std::optional<uint64_t> session_revision;  // Summary.session's: with another one the call is Aborted
  absl::Time deadline = absl::InfiniteFuture();
  CallCanceller* canceller = nullptr;  // may be null; outlives the call
};

// What a remeshing call tells while it runs, on the caller's thread and in the order of events. Implemented by the CLI and tests.
class RemeshObserver {
 public:
  virtual ~RemeshObserver() = default;
  virtual void OnUploaded() {}  // the last byte of the input is on its way
  virtual void OnAccepted(const v1::Accepted&) {}
  virtual void OnProgress(const v1::Progress&) {}
  virtual void OnDefect(const v1::Defect&) {}
  // The chunks so far are a whole level of detail, of which more follow: those after this are the next one's.
  virtual void OnLevelEnd(const v1::Summary&) {}
  // Faces of the input that the result has not any more (Region.patch_only), in increasing order and in pieces.
  virtual void OnRemovedFaces(absl::Span<const uint32_t>) {}
  // A verified piece of the result; the spans hold during the call. A status that is not OK ends the RPC and is returned.
  virtual absl::Status OnChunk(const v1::Chunk& chunk, const ChunkDecoder& decoded) = 0;
};

// A channel to HOST:PORT, without TLS. Connects with the first call.
std::shared_ptr<grpc::Channel> CreateRemoteChannel(const std::string& address);

// Blocking calls; safe to use from many threads. Statuses of the service come back with its code, message and details (as
// payloads, proto/wire/errors.h). Example:
//   RemeshClient client(CreateRemoteChannel("127.0.0.1:50051"));
//   MyObserver observer;
//   absl::StatusOr<v1::Summary> summary = client.Remesh(std::move(mesh), {}, observer);
class RemeshClient {
 public:
  explicit RemeshClient(const std::shared_ptr<grpc::ChannelInterface>& channel);

  // Sends the mesh (or point set) as float64 arrays in blocks of at most 1 MiB, frees it, and hands what comes back to the observer.
  // Returns the Summary, which is the commit mark: without it the result is to be thrown away. DataLoss when the stream is
  // damaged or ends without a Summary or with one that does not fit the chunks.
  absl::StatusOr<v1::Summary> Remesh(TriangleMesh mesh, const CallOptions& call, RemeshObserver& observer);
  // The same with call.options.lod_rhos: as many summaries as there are levels, in their order. Without the last of them nothing is whole.
  absl::StatusOr<std::vector<v1::Summary>> RemeshLevels(TriangleMesh mesh, const CallOptions& call,
                                                        RemeshObserver& observer);
  absl::StatusOr<v1::EstimateResponse> Estimate(TriangleMesh mesh, const CallOptions& call);
  absl::StatusOr<v1::GetCapabilitiesResponse> GetCapabilities(absl::Time deadline = absl::InfiniteFuture());

 private:
  std::unique_ptr<v1::MeshfrontService::StubInterface> stub_;
};

}  // namespace meshfront
