#include "client/chunk_decoder.h"

#include <bit>
#include <cmath>
#include <cstring>

#include "absl/strings/str_cat.h"
#include "core/base/status_macros.h"
#include "proto/wire/convert.h"
#include "proto/wire/crc32c.h"

namespace meshfront {
namespace {

static_assert(std::endian::native == std::endian::little,
              "arrays on the wire are little-endian and copied as they lie");

absl::Status Damaged(const v1::Chunk& chunk, absl::string_view what) {
  return absl::DataLossError(absl::StrCat("chunk ", chunk.sequence(), " is damaged: ", what));
}

Vec3 VectorAt(const std::string& bytes, size_t i, v1::ScalarType type) {
  Vec3 v;
  if (type == v1::SCALAR_TYPE_FLOAT32) {
    float f[3];
    std::memcpy(f, bytes.data() + i * sizeof(f), sizeof(f));
    v = {f[0], f[1], f[2]};
  } else {
    std::memcpy(&v, bytes.data() + i * sizeof(v), sizeof(v));
  }
  return v;
}

template <class Element>
void CopyElements(const std::string& bytes, std::vector<Element>& out) {
  out.resize(bytes.size() / sizeof(Element));
  if (!out.empty()) std::memcpy(out.data(), bytes.data(), bytes.size());
}

}  // namespace

absl::Status ChunkDecoder::CheckAttributes(const v1::Chunk& chunk) {
  const size_t values = chunk.wedge_values().size() / sizeof(float);
  if (stride_ == 0 && chunk.wedge_count() > 0) stride_ = values / chunk.wedge_count();
  if (chunk.wedge_values().size() != chunk.wedge_count() * stride_ * sizeof(float))
    return Damaged(chunk, "the size of its wedge values");
  const size_t triangles = chunk.triangle_count();
  if (!chunk.corner_wedges().empty() && chunk.corner_wedges().size() != triangles * sizeof(CornerWedges))
    return Damaged(chunk, "the size of its corner wedges");
  if (!chunk.groups().empty() && chunk.groups().size() != triangles * sizeof(uint32_t))
    return Damaged(chunk, "the size of its groups");
  return absl::OkStatus();
}

absl::Status ChunkDecoder::DecodeAttributes(const v1::Chunk& chunk) {
  MESHFRONT_RETURN_IF_ERROR(CheckAttributes(chunk));
  CopyElements(chunk.wedge_values(), wedge_values_);
  CopyElements(chunk.corner_wedges(), corner_wedges_);
  CopyElements(chunk.groups(), groups_);
  wedge_count_ += chunk.wedge_count();
  for (const float value : wedge_values_) {
    if (!std::isfinite(value)) return Damaged(chunk, "a value of a wedge is not finite");
  }
  for (const CornerWedges& corners : corner_wedges_) {
    for (const uint32_t w : corners) {
      if (w >= wedge_count_)
        return Damaged(chunk, absl::StrCat("a corner names wedge ", w, "; ", wedge_count_, " came so far"));
    }
  }
  return absl::OkStatus();
}

absl::Status ChunkDecoder::Decode(const v1::Chunk& chunk) {
  MESHFRONT_RETURN_IF_ERROR(CheckFrame(chunk));
  MESHFRONT_RETURN_IF_ERROR(DecodeVertices(chunk));
  vertex_count_ += chunk.vertex_count();
  MESHFRONT_RETURN_IF_ERROR(DecodeTriangles(chunk));
  triangle_count_ += chunk.triangle_count();
  MESHFRONT_RETURN_IF_ERROR(DecodeAttributes(chunk));
  chunks_crc32c_ = ExtendChunksCrc32c(chunks_crc32c_, chunk.crc32c());
  ++chunk_count_;
  return absl::OkStatus();
}

absl::Status ChunkDecoder::CheckFrame(const v1::Chunk& chunk) const {
  if (chunk.sequence() != chunk_count_) return Damaged(chunk, absl::StrCat("its turn was chunk ", chunk_count_));
  if (chunk.first_vertex() != vertex_count_) {
    return Damaged(chunk,
                   absl::StrCat("it begins at vertex ", chunk.first_vertex(), "; ", vertex_count_, " came before"));
  }
  const size_t vector_bytes = 3 * ScalarBytes(scalar_type_);
  if (chunk.positions().size() != chunk.vertex_count() * vector_bytes)
    return Damaged(chunk, "the size of its positions");
  if (!chunk.normals().empty() && chunk.normals().size() != chunk.positions().size()) {
    return Damaged(chunk, "the size of its normals");
  }
  if (chunk.indices().size() != size_t{chunk.triangle_count()} * sizeof(Triangle))
    return Damaged(chunk, "the size of its indices");
  if (vertex_count_ + chunk.vertex_count() >= VertexId::kInvalid) return Damaged(chunk, "more vertices than ids");
  if (ChunkCrc32c(chunk) != chunk.crc32c()) return Damaged(chunk, "its checksum differs");
  return absl::OkStatus();
}

absl::Status ChunkDecoder::DecodeVertices(const v1::Chunk& chunk) {
  vertices_.resize(chunk.vertex_count());
  for (size_t i = 0; i < vertices_.size(); ++i) {
    SpooledVertex& v = vertices_[i];
    v.position = VectorAt(chunk.positions(), i, scalar_type_);
    if (!IsFinite(v.position)) return Damaged(chunk, absl::StrCat("vertex ", vertex_count_ + i, " is not finite"));
    const Vec3 n = chunk.normals().empty() ? Vec3{} : VectorAt(chunk.normals(), i, scalar_type_);
    v.normal = {static_cast<float>(n.x), static_cast<float>(n.y), static_cast<float>(n.z)};
  }
  return absl::OkStatus();
}

absl::Status ChunkDecoder::DecodeTriangles(const v1::Chunk& chunk) {
  triangles_.resize(chunk.triangle_count());
  if (!triangles_.empty()) std::memcpy(triangles_.data(), chunk.indices().data(), chunk.indices().size());
  for (const Triangle& t : triangles_) {
    for (const VertexId v : t) {
      if (v.index() >= vertex_count_) {
        return Damaged(chunk, absl::StrCat("a triangle names vertex ", v.index(), "; ", vertex_count_, " came so far"));
      }
    }
  }
  return absl::OkStatus();
}

}  // namespace meshfront
