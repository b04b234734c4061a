// The vertices around each vertex, flat, and rings of them.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/types/span.h"
#include "core/base/context.h"
#include "core/mesh/adjacency.h"

namespace meshfront {

// neighbours[begin[v] .. begin[v + 1]) share an edge with v, counter-clockwise. At a hub with more than kMaxDegree neighbours
// every n-th is listed, so that no vertex costs more than that.
struct VertexRings {
  static constexpr uint32_t kMaxDegree = 32;
  std::vector<uint32_t> begin;
  std::vector<uint32_t> neighbours;

  absl::Span<const uint32_t> Of(uint32_t v) const {
    return absl::MakeConstSpan(neighbours).subspan(begin[v], begin[v + 1] - begin[v]);
  }
};
absl::StatusOr<VertexRings> CreateVertexRings(const TriangleMesh& mesh, const FaceAdjacency& adjacency,
                                              const Context& context);

// A vertex and those within a number of edges of it, nearest rings first; at most kCapacity. Reusable scratch, 4 bytes a vertex
// of the mesh.
class RingCollector {
 public:
  static constexpr uint32_t kCapacity = 256;

  explicit RingCollector(size_t vertex_count) : seen_(vertex_count, 0) {}

  // Begins again with `center` alone.
  void Start(uint32_t center);
  // Adds the next ring; false when there is none, or no room.
  bool Grow(const VertexRings& rings);

  uint32_t size() const { return count_; }
  int ring_count() const { return ring_; }
  uint32_t vertex(uint32_t i) const { return vertices_[i]; }
  int ring(uint32_t i) const { return ring_of_[i]; }

 private:
  std::vector<uint32_t> seen_;  // by vertex: the last generation that it was met in
  // A fan may run beyond the capacity before it is cut back.
  std::array<uint32_t, kCapacity + VertexRings::kMaxDegree> vertices_;
  std::array<uint8_t, kCapacity> ring_of_;
  uint32_t count_ = 0, last_ring_begin_ = 0, generation_ = 0;
  int ring_ = 0;
};

}  // namespace meshfront
