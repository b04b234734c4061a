#include "core/io/output.h"

#include <charconv>

namespace meshfront {

absl::Status StringSink::Append(std::string_view bytes) {
  text_.append(bytes);
  return absl::OkStatus();
}

void Output::Number(double value) {
  char text[32];
  const auto [stop, error] = std::to_chars(text, text + sizeof(text), value);
  Text({text, static_cast<size_t>(stop - text)});
}

void Output::Number(uint64_t value) {
  char text[24];
  const auto [stop, error] = std::to_chars(text, text + sizeof(text), value);
  Text({text, static_cast<size_t>(stop - text)});
}

void Output::Flush() {
  if (!buffer_.empty()) Pass(buffer_);
  buffer_.clear();
}

}  // namespace meshfront
