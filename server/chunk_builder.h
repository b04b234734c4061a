// Cuts the engine's pieces into chunks of the wire.
#pragma once

#include <cstdint>
#include <functional>

#include "absl/status/status.h"
#include "core/mesh/mesh_sink.h"
#include "meshfront/v1/mesh.pb.h"

namespace meshfront {

// Chunks begin with 4 KiB and double after every two until they have the size that was asked for: a small mesh comes
// in pieces too, a large one with little overhead. Cut by count, never by time, so the same mesh gives the same chunks.
class ChunkBuilder {
 public:
  static constexpr uint32_t kFirstBytes = 4 << 10;

  using Emit = std::function<absl::Status(v1::Chunk chunk)>;

  // `output` with every field set (NormalizeOutput). `emit` is called for each chunk; its error stops the builder.
  ChunkBuilder(const v1::OutputFormat& output, Emit emit);

  absl::Status Add(const MeshPiece& piece);
  // What is left, if anything. Once, last.
  absl::Status Flush();

  uint64_t chunks() const { return chunks_; }
  uint64_t vertices() const { return vertices_; }
  uint64_t triangles() const { return triangles_; }
  uint32_t chunks_crc32c() const { return chunks_crc32c_; }

 private:
  size_t Bytes() const;
  bool IsFull() const { return Bytes() >= target_; }
  absl::Status EmitChunk();
  void Begin();
  absl::Status AddWedges(const MeshPiece& piece);
  void AddVertex(const OutputVertex& vertex);

  const bool doubles_;
  const bool normals_;
  const bool finalised_;
  const uint32_t max_bytes_;
  Emit emit_;
  uint32_t target_ = kFirstBytes;
  uint64_t open_front_edges_ = 0;
  v1::Chunk chunk_;
  uint64_t chunks_ = 0, vertices_ = 0, triangles_ = 0;
  uint32_t chunks_crc32c_ = 0;
};

}  // namespace meshfront
