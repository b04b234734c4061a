// The engine's sink that streams: pieces to chunks to the ring.
#pragma once

#include <optional>

#include "absl/time/clock.h"
#include "core/mesh/mesh_sink.h"
#include "server/chunk_builder.h"
#include "server/event_stream.h"

namespace meshfront {

// Append blocks while the reader is slow; Aborted when it stalls, Cancelled when the call has ended.
class StreamSink : public MeshSink {
 public:
  StreamSink(EventStream& events, const v1::OutputFormat& output)
      : events_(events), builder_(output, [this](v1::Chunk chunk) {
          v1::MeshEvent event;
          *event.mutable_chunk() = std::move(chunk);
          return events_.Push(std::move(event));
        }) {}

  absl::Status Append(const MeshPiece& piece) override {
    if (!first_triangle_ && !piece.triangles.empty()) first_triangle_ = absl::Now();
    return builder_.Add(piece);
  }
  absl::Status Flush() { return builder_.Flush(); }

  const ChunkBuilder& builder() const { return builder_; }
  // When the first triangles came; unset before.
  std::optional<absl::Time> first_triangle() const { return first_triangle_; }

 private:
  EventStream& events_;
  ChunkBuilder builder_;
  std::optional<absl::Time> first_triangle_;
};

}  // namespace meshfront
