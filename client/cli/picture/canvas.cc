#include "client/cli/picture/canvas.h"

#include <png.h>

#include <algorithm>

#include "absl/strings/str_cat.h"
#include "client/cli/picture/font.h"

namespace meshfront {

static_assert(sizeof(Color) == 3, "libpng is handed the pixels as they lie");

Canvas::Canvas(int width, int height, Color background)
    : width_(width), height_(height), pixels_(static_cast<size_t>(width) * height, background) {}

void Canvas::Set(int x, int y, Color color) {
  if (x < 0 || y < 0 || x >= width_ || y >= height_) return;
  pixels_[static_cast<size_t>(y) * width_ + x] = color;
}

void Canvas::FillRect(const PixelRect& rect, Color color) {
  for (int y = std::max(0, rect.top); y < std::min(height_, rect.top + rect.height); ++y) {
    for (int x = std::max(0, rect.left); x < std::min(width_, rect.left + rect.width); ++x) Set(x, y, color);
  }
}

int Canvas::TextWidth(absl::string_view text, int scale) {
  return text.empty() ? 0 : static_cast<int>(text.size()) * (kGlyphColumns + 1) * scale - scale;
}

void Canvas::DrawText(int x, int y, int scale, absl::string_view text, Color color) {
  for (const char c : text) {
    const Glyph& glyph = GlyphOf(c);
    for (int row = 0; row < kGlyphRows; ++row) {
      for (int column = 0; column < kGlyphColumns; ++column) {
        if (glyph[row] >> (kGlyphColumns - 1 - column) & 1) {
          FillRect({x + column * scale, y + row * scale, scale, scale}, color);
        }
      }
    }
    x += (kGlyphColumns + 1) * scale;
  }
}

absl::Status Canvas::EncodePng(std::string* bytes) const {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = width_;
  image.height = height_;
  image.format = PNG_FORMAT_RGB;
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(image);
  bytes->resize(size);
  if (!png_image_write_to_memory(&image, bytes->data(), &size, 0, pixels_.data(), 0, nullptr)) {
    return absl::InternalError(absl::StrCat("the picture cannot be encoded: ", image.message));
  }
  bytes->resize(size);
  return absl::OkStatus();
}

}  // namespace meshfront
