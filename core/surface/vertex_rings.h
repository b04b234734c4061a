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
  static constexpr int kMaxRings = 8;

  explicit RingCollector(size_t vertex_count) : seen_(vertex_count, 0) {}

  // Begins again with `center` alone.
  void Start(uint32_t center);
  // Adds the next ring; false when there is none, or no room, or there are kMaxRings.
  bool Grow(const VertexRings& rings);

  uint32_t size() const { return count_; }
  int ring_count() const { return ring_; }
  uint32_t vertex(uint32_t i) const { return vertices_[i]; }
  // Ring i is vertices begin(i) to begin(i + 1); ring 0 is the centre.
  uint32_t begin(int i) const { return ring_begin_[i]; }
  // Vertices i to i + 3; beyond the last, the centre.
  std::array<uint32_t, 4> FourFrom(uint32_t i) const {
    return {vertices_[i], vertices_[i + 1], vertices_[i + 2], vertices_[i + 3]};
  }

 private:
  std::vector<uint32_t> seen_;  // by vertex: the last generation that it was met in
  // A fan may run beyond the capacity before it is cut back.
  std::array<uint32_t, kCapacity + VertexRings::kMaxDegree> vertices_;
  std::array<uint32_t, kMaxRings + 2> ring_begin_;
  uint32_t count_ = 0, generation_ = 0;
  int ring_ = 0;
};

}  // namespace meshfront
