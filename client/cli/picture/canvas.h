// An RGB picture in memory: rectangles, lines of text in a built-in font, and a PNG file at the end. Needs no display.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/strings/string_view.h"

namespace meshfront {

struct Color {
  uint8_t red = 0, green = 0, blue = 0;
  friend constexpr bool operator==(const Color&, const Color&) = default;
};

// A rectangle of pixels; (left, top) inside, (left + width, top + height) outside.
struct PixelRect {
  int left = 0, top = 0, width = 0, height = 0;
};

// Row-major, top row first. Drawing outside is clipped away.
class Canvas {
 public:
  Canvas(int width, int height, Color background);

  int width() const { return width_; }
  int height() const { return height_; }
  Color At(int x, int y) const { return pixels_[static_cast<size_t>(y) * width_ + x]; }
  void Set(int x, int y, Color color);
  void FillRect(const PixelRect& rect, Color color);
  // Text with its upper left corner at (x, y), each font pixel `scale` pixels wide. ASCII; lower case is drawn as upper case,
  // what the font lacks as a box.
  void DrawText(int x, int y, int scale, absl::string_view text, Color color);
  // Width in pixels of what DrawText would draw.
  static int TextWidth(absl::string_view text, int scale);

  // The bytes of the picture as a PNG file; Internal when libpng refuses.
  absl::Status EncodePng(std::string* bytes) const;

 private:
  int width_, height_;
  std::vector<Color> pixels_;
};

}  // namespace meshfront
