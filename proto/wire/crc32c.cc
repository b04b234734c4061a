#include "proto/wire/crc32c.h"

#include <array>
#include <bit>
#include <cstring>

#ifdef __SSE4_2__
#include <nmmintrin.h>
#endif

namespace meshfront {
namespace {

static_assert(std::endian::native == std::endian::little,
              "arrays on the wire are little-endian and copied as they are");

constexpr uint32_t kReversedPolynomial = 0x82f63b78;

constexpr std::array<uint32_t, 256> MakeTable() {
  std::array<uint32_t, 256> table{};
  for (uint32_t byte = 0; byte < 256; ++byte) {
    uint32_t remainder = byte;
    for (int bit = 0; bit < 8; ++bit) remainder = (remainder >> 1) ^ ((remainder & 1) ? kReversedPolynomial : 0);
    table[byte] = remainder;
  }
  return table;
}

}  // namespace

uint32_t PortableCrc32c(absl::string_view data, uint32_t crc) {
  static constexpr std::array<uint32_t, 256> kTable = MakeTable();
  crc = ~crc;
  for (const char c : data) crc = (crc >> 8) ^ kTable[(crc ^ static_cast<uint8_t>(c)) & 0xff];
  return ~crc;
}

uint32_t Crc32c(absl::string_view data, uint32_t crc) {
#ifdef __SSE4_2__
  uint64_t state = ~crc;
  const char* p = data.data();
  size_t left = data.size();
  for (; left >= 8; p += 8, left -= 8) {
    uint64_t word;
    std::memcpy(&word, p, 8);
    state = _mm_crc32_u64(state, word);
  }
  uint32_t tail = static_cast<uint32_t>(state);
  for (; left > 0; ++p, --left) tail = _mm_crc32_u8(tail, static_cast<uint8_t>(*p));
  return ~tail;
#else
  return PortableCrc32c(data, crc);
#endif
}

uint32_t ChunkCrc32c(const v1::Chunk& chunk) {
  uint32_t crc = Crc32c(chunk.positions());
  crc = Crc32c(chunk.normals(), crc);
  crc = Crc32c(chunk.indices(), crc);
  crc = Crc32c(chunk.finalised(), crc);
  crc = Crc32c(chunk.wedge_values(), crc);
  crc = Crc32c(chunk.corner_wedges(), crc);
  return Crc32c(chunk.groups(), crc);
}

uint32_t ExtendChunksCrc32c(uint32_t crc, uint32_t chunk_crc) {
  char bytes[4];
  std::memcpy(bytes, &chunk_crc, 4);
  return Crc32c(absl::string_view(bytes, 4), crc);
}

}  // namespace meshfront
