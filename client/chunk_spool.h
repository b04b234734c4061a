// Where the chunks of a result wait until it is whole: two nameless files, so that memory does not grow with the result.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/types/span.h"
#include "client/output_file.h"
#include "core/geometry/box.h"
#include "core/mesh/triangle_mesh.h"

namespace meshfront {

// A vertex as it is spooled. The normal is zero when the chunks had none.
struct SpooledVertex {
  Vec3 position;
  std::array<float, 3> normal{};
  float unused = 0;  // keeps the record free of padding
};
static_assert(sizeof(SpooledVertex) == 40);

// Vertices and triangles in the order of their arrival. Not thread-safe. Errors are Internal: the disk is full, or gone.
class ChunkSpool {
 public:
  // The files lie in `folder` without a name and vanish with the spool, however the process ends.
  static absl::StatusOr<ChunkSpool> Create(const std::string& folder);

  absl::Status Append(absl::Span<const SpooledVertex> vertices, absl::Span<const Triangle> triangles);
  // Attributes are held in memory, as the files that hold them are put together there.
  void AppendAttributes(absl::Span<const float> values, absl::Span<const CornerWedges> corners,
                        absl::Span<const uint32_t> groups);
  // Between the last Append and the first of the calls below.
  absl::Status Finish();

  uint64_t vertex_count() const { return vertex_count_; }
  uint64_t triangle_count() const { return triangle_count_; }
  const Box3& bounds() const { return bounds_; }  // of all vertices

  // In order, in blocks of bounded size; stops at the first status that is not OK and returns it.
  absl::Status ForEachVertexBlock(const std::function<absl::Status(absl::Span<const SpooledVertex>)>& body) const;
  absl::Status ForEachTriangleBlock(const std::function<absl::Status(absl::Span<const Triangle>)>& body) const;
  absl::Status ReadVertices(uint64_t first, absl::Span<SpooledVertex> vertices) const;
  // The whole mesh in memory, without normals: for a picture. With attributes, once, of these channels.
  absl::StatusOr<TriangleMesh> Load() const;
  absl::StatusOr<TriangleMesh> LoadWithAttributes(const std::vector<AttributeChannel>& channels);
  // With the vertices' normals as its one attribute, where the chunks had some.
  absl::StatusOr<TriangleMesh> LoadWithNormals() const;

 private:
  ChunkSpool(std::unique_ptr<BufferedFile> vertices, std::unique_ptr<BufferedFile> triangles);

  std::unique_ptr<BufferedFile> vertices_, triangles_;
  uint64_t vertex_count_ = 0, triangle_count_ = 0;
  Box3 bounds_;
  MeshAttributes attributes_;
};

// Positions of spooled vertices by id, through a cache of fixed size (2.5 MB): triangles name vertices that came shortly before.
class SpooledPositions {
 public:
  explicit SpooledPositions(const ChunkSpool& spool);
  absl::StatusOr<Vec3> At(VertexId v);

 private:
  static constexpr uint64_t kBlock = 256, kSlots = 256;  // vertices a block, blocks held

  const ChunkSpool& spool_;
  std::vector<uint64_t> held_;  // the block in each slot
  std::vector<SpooledVertex> cache_;
};

}  // namespace meshfront
