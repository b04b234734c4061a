// Four comparisons at once: what the compiler's vectors of floats answer, as bits.
#pragma once

#include <array>
#include <bit>
#include <cstdint>

namespace meshfront {

typedef float FourFloats __attribute__((vector_size(16)));
typedef int32_t FourFlags __attribute__((vector_size(16)));  // a lane is −1 where it is true, else 0

// Bit i is set where lane i is true.
inline uint32_t LanesOf(const FourFlags& are_true) {
  const auto halves = std::bit_cast<std::array<uint64_t, 2>>(are_true & FourFlags{1, 2, 4, 8});
  const uint64_t both = halves[0] | halves[1];
  return static_cast<uint32_t>(both | both >> 32);
}

}  // namespace meshfront
