#include "client/chunk_spool.h"

#include <algorithm>
#include <utility>

#include "core/base/status_macros.h"

namespace meshfront {
namespace {

constexpr uint64_t kBlockRecords = 4096;

template <class Record>
absl::Status ForEachBlock(const BufferedFile& file, uint64_t count,
                          const std::function<absl::Status(absl::Span<const Record>)>& body) {
  std::vector<Record> block;
  for (uint64_t first = 0; first < count; first += kBlockRecords) {
    block.resize(std::min(kBlockRecords, count - first));
    MESHFRONT_RETURN_IF_ERROR(file.ReadAt(first * sizeof(Record), block.data(), block.size() * sizeof(Record)));
    MESHFRONT_RETURN_IF_ERROR(body(block));
  }
  return absl::OkStatus();
}

template <class Record>
absl::string_view BytesOf(absl::Span<const Record> records) {
  return {reinterpret_cast<const char*>(records.data()), records.size() * sizeof(Record)};
}

}  // namespace

ChunkSpool::ChunkSpool(std::unique_ptr<BufferedFile> vertices, std::unique_ptr<BufferedFile> triangles)
    : vertices_(std::move(vertices)), triangles_(std::move(triangles)) {}

absl::StatusOr<ChunkSpool> ChunkSpool::Create(const std::string& folder) {
  MESHFRONT_ASSIGN_OR_RETURN(std::unique_ptr<BufferedFile> vertices, CreateSpoolFile(folder));
  MESHFRONT_ASSIGN_OR_RETURN(std::unique_ptr<BufferedFile> triangles, CreateSpoolFile(folder));
  return ChunkSpool(std::move(vertices), std::move(triangles));
}

absl::Status ChunkSpool::Append(absl::Span<const SpooledVertex> vertices, absl::Span<const Triangle> triangles) {
  for (const SpooledVertex& v : vertices) bounds_.Extend(v.position);
  vertex_count_ += vertices.size();
  triangle_count_ += triangles.size();
  MESHFRONT_RETURN_IF_ERROR(vertices_->Append(BytesOf(vertices)));
  return triangles_->Append(BytesOf(triangles));
}

void ChunkSpool::AppendAttributes(absl::Span<const float> values, absl::Span<const CornerWedges> corners,
                                  absl::Span<const uint32_t> groups) {
  attributes_.values.insert(attributes_.values.end(), values.begin(), values.end());
  attributes_.corners.insert(attributes_.corners.end(), corners.begin(), corners.end());
  attributes_.groups.insert(attributes_.groups.end(), groups.begin(), groups.end());
}

absl::StatusOr<TriangleMesh> ChunkSpool::LoadWithAttributes(const std::vector<AttributeChannel>& channels) {
  MESHFRONT_ASSIGN_OR_RETURN(TriangleMesh mesh, Load());
  mesh.attributes = std::exchange(attributes_, {});
  if (!mesh.attributes.corners.empty()) mesh.attributes.channels = channels;
  return mesh;
}

absl::Status ChunkSpool::Finish() {
  MESHFRONT_RETURN_IF_ERROR(vertices_->Flush());
  return triangles_->Flush();
}

absl::Status ChunkSpool::ForEachVertexBlock(
    const std::function<absl::Status(absl::Span<const SpooledVertex>)>& body) const {
  return ForEachBlock<SpooledVertex>(*vertices_, vertex_count_, body);
}

absl::Status ChunkSpool::ForEachTriangleBlock(
    const std::function<absl::Status(absl::Span<const Triangle>)>& body) const {
  return ForEachBlock<Triangle>(*triangles_, triangle_count_, body);
}

absl::Status ChunkSpool::ReadVertices(uint64_t first, absl::Span<SpooledVertex> vertices) const {
  return vertices_->ReadAt(first * sizeof(SpooledVertex), vertices.data(), vertices.size() * sizeof(SpooledVertex));
}

absl::StatusOr<TriangleMesh> ChunkSpool::Load() const {
  TriangleMesh mesh;
  mesh.positions.reserve(vertex_count_);
  mesh.triangles.reserve(triangle_count_);
  MESHFRONT_RETURN_IF_ERROR(ForEachVertexBlock([&](absl::Span<const SpooledVertex> block) {
    for (const SpooledVertex& v : block) mesh.positions.push_back(v.position);
    return absl::OkStatus();
  }));
  MESHFRONT_RETURN_IF_ERROR(ForEachTriangleBlock([&](absl::Span<const Triangle> block) {
    mesh.triangles.insert(mesh.triangles.end(), block.begin(), block.end());
    return absl::OkStatus();
  }));
  return mesh;
}

absl::StatusOr<TriangleMesh> ChunkSpool::LoadWithNormals() const {
  MESHFRONT_ASSIGN_OR_RETURN(TriangleMesh mesh, Load());
  MeshAttributes& a = mesh.attributes;
  a.channels = {{"NORMAL", 3}};
  MESHFRONT_RETURN_IF_ERROR(ForEachVertexBlock([&](absl::Span<const SpooledVertex> block) {
    for (const SpooledVertex& v : block) a.values.insert(a.values.end(), v.normal.begin(), v.normal.end());
    return absl::OkStatus();
  }));
  for (const Triangle& t : mesh.triangles) a.corners.push_back({t[0].index(), t[1].index(), t[2].index()});
  return mesh;
}

SpooledPositions::SpooledPositions(const ChunkSpool& spool)
    : spool_(spool), held_(kSlots, ~uint64_t{0}), cache_(kSlots * kBlock) {}

absl::StatusOr<Vec3> SpooledPositions::At(VertexId v) {
  const uint64_t block = v.index() / kBlock, slot = block % kSlots;
  if (held_[slot] != block) {
    const uint64_t first = block * kBlock, count = std::min(kBlock, spool_.vertex_count() - first);
    MESHFRONT_RETURN_IF_ERROR(spool_.ReadVertices(first, absl::MakeSpan(&cache_[slot * kBlock], count)));
    held_[slot] = block;
  }
  return cache_[slot * kBlock + v.index() % kBlock].position;
}

}  // namespace meshfront
