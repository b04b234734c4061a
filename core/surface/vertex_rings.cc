#include "core/surface/vertex_rings.h"

#include <algorithm>

#include "core/base/status_macros.h"

namespace meshfront {
namespace {

constexpr size_t kGrain = 4096;

uint32_t StrideOf(uint32_t degree) { return (degree + VertexRings::kMaxDegree - 1) / VertexRings::kMaxDegree; }

}  // namespace

absl::StatusOr<VertexRings> CreateVertexRings(const TriangleMesh& mesh, const FaceAdjacency& adjacency,
                                              const Context& context) {
  const size_t count = mesh.positions.size();
  VertexRings rings;
  rings.begin.assign(count + 1, 0);
  std::vector<uint32_t> degrees(count, 0);
  MESHFRONT_RETURN_IF_ERROR(ParallelFor(count, kGrain, context, [&](size_t begin, size_t end) {
    for (size_t v = begin; v < end; ++v) {
      uint32_t degree = 0;
      VisitNeighbours(mesh, adjacency, static_cast<uint32_t>(v), [&](VertexId) { ++degree; });
      degrees[v] = degree;
    }
  }));
  for (size_t v = 0; v < count; ++v) {
    const uint32_t stride = degrees[v] > 0 ? StrideOf(degrees[v]) : 1;
    rings.begin[v + 1] = rings.begin[v] + (degrees[v] + stride - 1) / stride;
  }
  rings.neighbours.resize(rings.begin[count]);
  MESHFRONT_RETURN_IF_ERROR(ParallelFor(count, kGrain, context, [&](size_t begin, size_t end) {
    for (size_t v = begin; v < end; ++v) {
      uint32_t at = rings.begin[v], i = 0;
      const uint32_t stride = degrees[v] > 0 ? StrideOf(degrees[v]) : 1;
      VisitNeighbours(mesh, adjacency, static_cast<uint32_t>(v), [&](VertexId neighbour) {
        if (stride == 1 || i++ % stride == 0) rings.neighbours[at++] = neighbour.index();
      });
    }
  }));
  return rings;
}

void RingCollector::Start(uint32_t center) {
  if (++generation_ == 0) {
    std::fill(seen_.begin(), seen_.end(), 0);
    generation_ = 1;
  }
  seen_[center] = generation_;
  vertices_[0] = center;
  ring_begin_[0] = 0;
  ring_begin_[1] = count_ = 1;
  ring_ = 0;
}

// Without a branch per neighbour: two in three have been met before, in no order that a processor could predict.
bool RingCollector::Grow(const VertexRings& rings) {
  const uint32_t begin = ring_begin_[ring_], end = count_;
  if (count_ == kCapacity || ring_ == kMaxRings) return false;
  ++ring_;
  // Locals, which the stores below cannot be taken to change.
  uint32_t* const seen = seen_.data();
  uint32_t* const vertices = vertices_.data();
  const uint32_t* const neighbours = rings.neighbours.data();
  const uint32_t* const begins = rings.begin.data();
  const uint32_t generation = generation_;
  size_t count = end;
  const auto meet = [&](uint32_t v) {
    vertices[count] = v;
    count += seen[v] < generation;  // or equal
    seen[v] = generation;
  };
  for (uint32_t i = begin; i < end && count < kCapacity; ++i) {
    const uint32_t *ring = neighbours + begins[vertices[i]], *const last = neighbours + begins[vertices[i] + 1];
    if (last - ring == 6) {  // as most are
      meet(ring[0]), meet(ring[1]), meet(ring[2]), meet(ring[3]), meet(ring[4]), meet(ring[5]);
      continue;
    }
    for (; ring != last; ++ring) meet(*ring);
  }
  count_ = static_cast<uint32_t>(std::min<size_t>(count, kCapacity));
  ring_begin_[ring_ + 1] = count_;
  std::fill_n(vertices_.begin() + count_, 3, vertices_[0]);  // for FourFrom
  return count_ > end;
}

}  // namespace meshfront
