// Base64 with the standard alphabet (RFC 4648, section 4).
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "core/io/file_bytes.h"
#include "core/io/output.h"

namespace meshfront {

// False when a character does not belong there or the length is impossible. Padding may be missing. `out` is 3/4 of the text.
bool DecodeBase64(std::string_view text, ByteBuffer& out);

// Encodes what it is given into an Output; Finish writes the last group with its padding.
class Base64Sink : public ByteSink {
 public:
  explicit Base64Sink(Output& next) : next_(next) {}
  absl::Status Append(std::string_view bytes) override;
  void Finish();

 private:
  void Group();
  Output& next_;
  std::array<uint8_t, 3> group_ = {};
  int filled_ = 0;
};

}  // namespace meshfront
