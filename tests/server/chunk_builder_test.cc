#include "server/chunk_builder.h"

#include <gtest/gtest.h>

#include <cstring>

#include "proto/wire/convert.h"
#include "proto/wire/crc32c.h"
#include "tests/server/fakes.h"

namespace meshfront {
namespace {

v1::OutputFormat Output(uint32_t chunk_bytes, bool doubles = false) {
  v1::OutputFormat output;
  output.set_chunk_bytes(chunk_bytes);
  output.set_scalar_type(doubles ? v1::SCALAR_TYPE_FLOAT64 : v1::SCALAR_TYPE_FLOAT32);
  return output;
}

class BuilderSink : public MeshSink {
 public:
  explicit BuilderSink(const v1::OutputFormat& output)
      : builder(output, [this](v1::Chunk chunk) {
          chunks.push_back(std::move(chunk));
          return absl::OkStatus();
        }) {}
  absl::Status Append(const MeshPiece& piece) override { return builder.Add(piece); }

  std::vector<v1::Chunk> chunks;
  ChunkBuilder builder;
};

std::vector<v1::Chunk> ChunksOfStrip(uint64_t triangles, const v1::OutputFormat& output) {
  BuilderSink sink(output);
  EXPECT_TRUE(EmitStrip(triangles, sink, Context()).ok());
  EXPECT_TRUE(sink.builder.Flush().ok());
  return std::move(sink.chunks);
}

size_t BytesOf(const v1::Chunk& chunk) {
  return chunk.positions().size() + chunk.normals().size() + chunk.indices().size();
}

TEST(ChunkBuilder, ConcatenatesToTheMesh) {
  const std::vector<v1::Chunk> chunks = ChunksOfStrip(20'000, Output(kMinChunkBytes, /*doubles=*/true));
  CollectingSink whole;
  ASSERT_TRUE(EmitStrip(20'000, whole, Context()).ok());
  std::string positions, indices;
  for (const v1::Chunk& chunk : chunks) positions += chunk.positions(), indices += chunk.indices();
  ASSERT_EQ(positions.size(), whole.mesh.positions.size() * sizeof(Vec3));
  ASSERT_EQ(indices.size(), whole.mesh.triangles.size() * sizeof(Triangle));
  EXPECT_EQ(std::memcmp(positions.data(), whole.mesh.positions.data(), positions.size()), 0);
  EXPECT_EQ(std::memcmp(indices.data(), whole.mesh.triangles.data(), indices.size()), 0);
}

TEST(ChunkBuilder, SendsAVertexBeforeItsFirstTriangleAndCountsOn) {
  uint64_t vertices = 0, sequence = 0;
  for (const v1::Chunk& chunk : ChunksOfStrip(50'000, Output(kMinChunkBytes))) {
    EXPECT_EQ(chunk.sequence(), sequence++);
    EXPECT_EQ(chunk.first_vertex(), vertices);
    EXPECT_EQ(chunk.positions().size(), chunk.vertex_count() * 12u);
    EXPECT_EQ(chunk.indices().size(), chunk.triangle_count() * 12u);
    vertices += chunk.vertex_count();
    std::vector<uint32_t> indices(3 * chunk.triangle_count());
    std::memcpy(indices.data(), chunk.indices().data(), chunk.indices().size());
    for (const uint32_t index : indices) ASSERT_LT(index, vertices);
  }
  EXPECT_EQ(vertices, 50'002u);
}

TEST(ChunkBuilder, GrowsFromFourKibibytesToTheSizeAskedFor) {
  const std::vector<v1::Chunk> chunks = ChunksOfStrip(100'000, Output(128 << 10));
  ASSERT_GT(chunks.size(), 13u);
  EXPECT_LT(BytesOf(chunks[0]), 4200u);
  for (size_t i = 1; i + 1 < chunks.size(); ++i) EXPECT_GE(BytesOf(chunks[i]) + 24, BytesOf(chunks[i - 1])) << i;
  EXPECT_NEAR(BytesOf(chunks[chunks.size() - 2]), 128 << 10, 24);
}

TEST(ChunkBuilder, SendsASmallMeshInSeveralPiecesToo) {
  EXPECT_GE(ChunksOfStrip(16'000, Output(128 << 10)).size(), 10u);
}

TEST(ChunkBuilder, ChecksumsEveryChunkAndAllOfThem) {
  BuilderSink sink(Output(kMinChunkBytes));
  ASSERT_TRUE(EmitStrip(5'000, sink, Context()).ok());
  ASSERT_TRUE(sink.builder.Flush().ok());
  uint32_t all = 0;
  for (const v1::Chunk& chunk : sink.chunks) {
    EXPECT_EQ(chunk.crc32c(), Crc32c(chunk.indices(), Crc32c(chunk.positions())));
    all = ExtendChunksCrc32c(all, chunk.crc32c());
  }
  EXPECT_EQ(all, sink.builder.chunks_crc32c());
  EXPECT_EQ(sink.chunks.size(), sink.builder.chunks());
}

TEST(ChunkBuilder, CarriesNormalsAndFinalisedVerticesOnlyWhenAsked) {
  v1::OutputFormat output = Output(kMinChunkBytes);
  const std::vector<OutputVertex> vertices = {{{1, 2, 3}, {0, 0, 1}}};
  const std::vector<VertexId> finalised = {VertexId(0)};
  for (const bool wanted : {false, true}) {
    output.set_normals(wanted);
    output.set_finalised(wanted);
    BuilderSink sink(output);
    ASSERT_TRUE(sink.Append({vertices, {}, finalised, 7}).ok());
    ASSERT_TRUE(sink.builder.Flush().ok());
    ASSERT_EQ(sink.chunks.size(), 1u);
    EXPECT_EQ(sink.chunks[0].normals().size(), wanted ? 12u : 0u);
    EXPECT_EQ(sink.chunks[0].finalised().size(), wanted ? 4u : 0u);
    EXPECT_EQ(sink.chunks[0].open_front_edges(), 7u);
  }
}

TEST(ChunkBuilder, StopsWithTheErrorOfItsReceiver) {
  ChunkBuilder builder(Output(kMinChunkBytes), [](v1::Chunk) { return absl::CancelledError("enough"); });
  const std::vector<OutputVertex> vertices(1000);
  EXPECT_EQ(builder.Add({vertices, {}, {}, 0}).code(), absl::StatusCode::kCancelled);
}

}  // namespace
}  // namespace meshfront
