#include "server/chunk_builder.h"

#include <algorithm>
#include <utility>

#include "core/base/status_macros.h"
#include "proto/wire/crc32c.h"

namespace meshfront {
namespace {

template <class T>
void AppendRaw(std::string& out, const T& value) {
  out.append(reinterpret_cast<const char*>(&value), sizeof(T));
}

void AppendVector(std::string& out, const Vec3& v, bool doubles) {
  if (doubles) {
    const double xyz[3] = {v.x, v.y, v.z};
    AppendRaw(out, xyz);
  } else {
    const float xyz[3] = {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
    AppendRaw(out, xyz);
  }
}

}  // namespace

ChunkBuilder::ChunkBuilder(const v1::OutputFormat& output, Emit emit)
    : doubles_(output.scalar_type() == v1::SCALAR_TYPE_FLOAT64),
      normals_(output.normals()),
      finalised_(output.finalised()),
      max_bytes_(output.chunk_bytes()),
      emit_(std::move(emit)) {
  Begin();
}

void ChunkBuilder::Begin() {
  chunk_.Clear();
  chunk_.set_sequence(chunks_);
  chunk_.set_first_vertex(vertices_);
}

size_t ChunkBuilder::Bytes() const {
  return chunk_.positions().size() + chunk_.normals().size() + chunk_.indices().size() + chunk_.finalised().size() +
         chunk_.wedge_values().size() + chunk_.corner_wedges().size() + chunk_.groups().size();
}

void ChunkBuilder::AddVertex(const OutputVertex& vertex) {
  AppendVector(*chunk_.mutable_positions(), vertex.position, doubles_);
  if (normals_) AppendVector(*chunk_.mutable_normals(), vertex.normal, doubles_);
  chunk_.set_vertex_count(chunk_.vertex_count() + 1);
  ++vertices_;
}

absl::Status ChunkBuilder::AddWedges(const MeshPiece& piece) {
  if (piece.wedges.empty()) return absl::OkStatus();
  const size_t stride = piece.wedge_values.size() / piece.wedges.size();
  for (size_t i = 0; i < piece.wedges.size(); ++i) {
    for (const float value : piece.wedge_values.subspan(i * stride, stride))
      AppendRaw(*chunk_.mutable_wedge_values(), value);
    chunk_.set_wedge_count(chunk_.wedge_count() + 1);
    if (IsFull()) MESHFRONT_RETURN_IF_ERROR(EmitChunk());
  }
  return absl::OkStatus();
}

// All vertices of a piece, and its wedges, go before its triangles, so a vertex precedes its first triangle wherever the piece is cut.
absl::Status ChunkBuilder::Add(const MeshPiece& piece) {
  open_front_edges_ = piece.open_front_edges;
  for (const OutputVertex& vertex : piece.vertices) {
    AddVertex(vertex);
    if (IsFull()) MESHFRONT_RETURN_IF_ERROR(EmitChunk());
  }
  MESHFRONT_RETURN_IF_ERROR(AddWedges(piece));
  for (size_t i = 0; i < piece.triangles.size(); ++i) {
    AppendRaw(*chunk_.mutable_indices(), piece.triangles[i]);
    if (!piece.corners.empty()) AppendRaw(*chunk_.mutable_corner_wedges(), piece.corners[i]);
    if (!piece.groups.empty()) AppendRaw(*chunk_.mutable_groups(), piece.groups[i]);
    chunk_.set_triangle_count(chunk_.triangle_count() + 1);
    ++triangles_;
    if (IsFull()) MESHFRONT_RETURN_IF_ERROR(EmitChunk());
  }
  if (!finalised_) return absl::OkStatus();
  for (const VertexId vertex : piece.finalised) {
    AppendRaw(*chunk_.mutable_finalised(), vertex);
    if (IsFull()) MESHFRONT_RETURN_IF_ERROR(EmitChunk());
  }
  return absl::OkStatus();
}

absl::Status ChunkBuilder::Flush() { return Bytes() > 0 ? EmitChunk() : absl::OkStatus(); }

absl::Status ChunkBuilder::EmitChunk() {
  chunk_.set_open_front_edges(open_front_edges_);
  chunk_.set_crc32c(ChunkCrc32c(chunk_));
  chunks_crc32c_ = ExtendChunksCrc32c(chunks_crc32c_, chunk_.crc32c());
  ++chunks_;
  if (chunks_ % 2 == 0) target_ = std::min(2 * target_, max_bytes_);
  v1::Chunk full = std::exchange(chunk_, v1::Chunk());
  Begin();
  return emit_(std::move(full));
}

}  // namespace meshfront
