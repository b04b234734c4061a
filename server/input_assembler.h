// Puts an upload together, checking every bound as the blocks arrive.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "core/io/mesh_io.h"
#include "core/remesh.h"
#include "meshfront/v1/mesh.pb.h"
#include "proto/wire/sha256.h"
#include "server/array_writer.h"
#include "server/config.h"

namespace meshfront {

// An upload that is whole: a mesh, a file that is still to be parsed (`file` not empty), or the name of a session.
struct AssembledInput {
  TriangleMesh mesh;
  std::optional<Region> region;  // the part of it to remesh
  Polylines features;            // to be kept
  std::vector<uint8_t> file;
  Format format = Format::kUnknown;
  std::string file_name;
  std::string session_id;
  std::optional<uint64_t> session_revision;  // that the session's mesh must have
};

// Header, blocks, end: one message after the other. InvalidArgument: order, options, arrays; ResourceExhausted: limits;
// DataLoss: checksums. After an error it is to be thrown away. Memory follows what was received, not what was
// announced. Not thread-safe.
class InputAssembler {
 public:
  explicit InputAssembler(const ServerLimits& limits) : limits_(limits) {}

  absl::Status Accept(const v1::Header& header);
  absl::Status Accept(const v1::DataBlock& block);
  absl::Status Accept(const v1::EndOfInput& end);
  // One message of either rpc: the oneof of RemeshRequest and EstimateRequest.
  template <class Request>
  absl::Status AcceptMessage(const Request& request) {
    if (request.has_header()) return Accept(request.header());
    if (request.has_block()) return Accept(request.block());
    if (request.has_end()) return Accept(request.end());
    return absl::InvalidArgumentError("message is empty; it must hold header, block or end");
  }

  bool has_header() const { return state_ != State::kHeader; }
  bool whole() const { return state_ == State::kWhole; }
  uint64_t bytes() const { return bytes_; }
  // The memory that the arrays take now: 0 once they were taken.
  uint64_t allocated_bytes() const;
  // The most that they will take while a message is accepted: an array that grows is there twice for a moment.
  template <class Request>
  uint64_t BytesToAccept(const Request& request) {
    return allocated_bytes() + (request.has_block() ? GrowthFor(request.block()) : 0);
  }
  // Valid once there is a header.
  const std::string& request_id() const { return request_id_; }
  const RemeshOptions& options() const { return options_; }
  const v1::OutputFormat& output() const { return output_; }
  uint32_t requested_threads() const { return requested_threads_; }
  bool keeps_session() const { return keeps_session_; }
  bool names_session() const { return names_session_; }
  bool updates_session() const { return updates_session_; }
  // Once, when whole.
  AssembledInput Take() { return std::move(input_); }

 private:
  enum class State { kHeader, kBlocks, kWhole };

  absl::Status AnnounceArrays(uint64_t vertices, uint64_t triangles, v1::ScalarType scalar_type, bool normals);
  absl::Status AnnounceMesh(const v1::MeshArrays& mesh);
  absl::Status AnnounceAttributes(const v1::MeshArrays& mesh);
  absl::Status AnnouncePoints(const v1::PointSet& points);
  absl::Status AnnounceFile(const v1::WholeFile& file);
  absl::Status AnnounceSession(const v1::Header& header);
  absl::Status CheckSessionFields(const v1::Header& header) const;
  absl::Status CheckAnnouncedBytes() const;
  absl::Status AnnounceRegion(const v1::RemeshOptions& options);
  absl::Status AnnounceFeatures(const v1::RemeshOptions& options, const v1::Header& header);
  absl::Status CheckNewIndices();
  uint64_t GrowthFor(const v1::DataBlock& block);
  ArrayWriter* Find(v1::Array array);

  ServerLimits limits_;
  State state_ = State::kHeader;
  std::string request_id_;
  RemeshOptions options_;
  v1::OutputFormat output_;
  uint32_t requested_threads_ = 0;
  bool keeps_session_ = false, names_session_ = false, updates_session_ = false;
  uint64_t vertex_count_ = 0;
  size_t checked_triangles_ = 0;
  uint64_t bytes_ = 0;
  Sha256 sha256_;
  AssembledInput input_;
  std::vector<uint32_t> region_faces_;
  std::vector<uint32_t> segment_ends_;  // of features, two each
  std::vector<ArrayWriter> arrays_;
};

}  // namespace meshfront
