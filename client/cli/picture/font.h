// A bitmap font of capitals, digits and some punctuation, five columns by seven rows.
#pragma once

#include <array>
#include <cstdint>

namespace meshfront {

inline constexpr int kGlyphColumns = 5;
inline constexpr int kGlyphRows = 7;
// One byte a row, top row first; bit 4 is the leftmost column.
using Glyph = std::array<uint8_t, kGlyphRows>;

// The glyph of an ASCII character; lower case gives upper case, anything unknown a box.
const Glyph& GlyphOf(char c);

}  // namespace meshfront
