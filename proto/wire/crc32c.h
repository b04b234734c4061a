// CRC-32C (Castagnoli), the checksum of blocks and chunks.
#pragma once

#include <cstdint>

#include "absl/strings/string_view.h"
#include "meshfront/v1/mesh.pb.h"

namespace meshfront {

// CRC-32C of `data` appended to what `crc` is the checksum of; 0 begins. Crc32c("123456789") == 0xe3069283. About 7
// GB/s with SSE 4.2, 0.4 GB/s without.
uint32_t Crc32c(absl::string_view data, uint32_t crc = 0);
// The table-driven version, for processors without the instruction, and to test the other against.
uint32_t PortableCrc32c(absl::string_view data, uint32_t crc = 0);

// What Chunk.crc32c must be: over the bytes fields in field-number order.
uint32_t ChunkCrc32c(const v1::Chunk& chunk);
// Summary.chunks_crc32c after one more chunk: `crc` so far (0 begins), extended by the chunk's own checksum.
uint32_t ExtendChunksCrc32c(uint32_t crc, uint32_t chunk_crc);

}  // namespace meshfront
