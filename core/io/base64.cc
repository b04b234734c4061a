#include "core/io/base64.h"

namespace meshfront {
namespace {

constexpr std::string_view kAlphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

std::array<int8_t, 256> MakeValues() {
  std::array<int8_t, 256> values;
  values.fill(-1);
  for (size_t i = 0; i < kAlphabet.size(); ++i) values[static_cast<uint8_t>(kAlphabet[i])] = static_cast<int8_t>(i);
  return values;
}

}  // namespace

bool DecodeBase64(std::string_view text, ByteBuffer& out) {
  static const std::array<int8_t, 256> kValues = MakeValues();
  for (int i = 0; i < 2 && !text.empty() && text.back() == '='; ++i) text.remove_suffix(1);
  if (text.size() % 4 == 1 || !out.Resize(text.size() / 4 * 3 + (text.size() % 4) * 3 / 4)) return false;
  uint32_t bits = 0;
  int count = 0;
  uint8_t* to = out.data();
  for (const char c : text) {
    const int8_t value = kValues[static_cast<uint8_t>(c)];
    if (value < 0) return false;
    bits = (bits << 6) | static_cast<uint32_t>(value);
    count += 6;
    if (count < 8) continue;
    count -= 8;
    *to++ = static_cast<uint8_t>(bits >> count);
  }
  return true;
}

absl::Status Base64Sink::Append(std::string_view bytes) {
  for (const char c : bytes) {
    group_[filled_++] = static_cast<uint8_t>(c);
    if (filled_ == 3) Group();
  }
  return absl::OkStatus();
}

void Base64Sink::Group() {
  const uint32_t bits = (uint32_t{group_[0]} << 16) | (uint32_t{group_[1]} << 8) | group_[2];
  char text[4];
  for (int i = 0; i < 4; ++i) text[i] = i > filled_ ? '=' : kAlphabet[(bits >> (18 - 6 * i)) & 63];
  next_.Text({text, 4});
  group_ = {}, filled_ = 0;
}

void Base64Sink::Finish() {
  if (filled_ > 0) Group();
}

}  // namespace meshfront
