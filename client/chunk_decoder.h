// From chunks on the wire to vertices and triangles, everything checked.
#pragma once

#include <vector>

#include "absl/status/status.h"
#include "client/chunk_spool.h"
#include "meshfront/v1/mesh.pb.h"

namespace meshfront {

// Checks a result stream as it arrives: sequence, sizes, checksums, ids, finite coordinates. A server that is damaged or hostile can make
// it fail but not write out of bounds. One per call; not thread-safe.
class ChunkDecoder {
 public:
  explicit ChunkDecoder(v1::ScalarType scalar_type) : scalar_type_(scalar_type) {}

  // Fills vertices() and triangles() with the chunk's. DataLoss naming the chunk and what is wrong with it.
  absl::Status Decode(const v1::Chunk& chunk);
  absl::Span<const SpooledVertex> vertices() const { return vertices_; }
  absl::Span<const Triangle> triangles() const { return triangles_; }
  // Of the chunk's wedges and triangles; empty where the result has none.
  absl::Span<const float> wedge_values() const { return wedge_values_; }
  absl::Span<const CornerWedges> corner_wedges() const { return corner_wedges_; }
  absl::Span<const uint32_t> groups() const { return groups_; }

  // Totals so far.
  uint64_t chunk_count() const { return chunk_count_; }
  uint64_t vertex_count() const { return vertex_count_; }
  uint64_t triangle_count() const { return triangle_count_; }
  // What Summary.chunks_crc32c must be.
  uint32_t chunks_crc32c() const { return chunks_crc32c_; }

 private:
  absl::Status CheckFrame(const v1::Chunk& chunk) const;
  absl::Status DecodeVertices(const v1::Chunk& chunk);
  absl::Status DecodeTriangles(const v1::Chunk& chunk);
  absl::Status CheckAttributes(const v1::Chunk& chunk);
  absl::Status DecodeAttributes(const v1::Chunk& chunk);

  v1::ScalarType scalar_type_;
  uint64_t chunk_count_ = 0, vertex_count_ = 0, triangle_count_ = 0;
  uint32_t chunks_crc32c_ = 0;
  std::vector<SpooledVertex> vertices_;
  std::vector<Triangle> triangles_;
  uint64_t wedge_count_ = 0, stride_ = 0;  // stride: 0 until the first wedge
  std::vector<float> wedge_values_;
  std::vector<CornerWedges> corner_wedges_;
  std::vector<uint32_t> groups_;
};

}  // namespace meshfront
