#include "core/io/text_scanner.h"

#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>

#include "absl/strings/charconv.h"

namespace meshfront {
namespace {

bool IsBlank(char c) { return c == ' ' || c == '\t' || c == '\v' || c == '\f'; }
bool IsLineEnd(char c) { return c == '\n' || c == '\r'; }

// What std::from_chars leaves open: the value of a number beyond the range of doubles.
double BeyondRange(const char* begin, const char* end) {
  double value = 0;
  absl::from_chars(begin, end, value);
  if (std::fabs(value) < 1) return std::copysign(0.0, value);
  return std::copysign(std::numeric_limits<double>::infinity(), value);
}

}  // namespace

TextScanner::TextScanner(std::string_view text, Dialect dialect)
    : begin_(text.data()), at_(text.data()), end_(text.data() + text.size()), dialect_(dialect) {
  if (text.substr(0, 3) == "\xef\xbb\xbf") at_ += 3;  // a byte order mark
}

bool TextScanner::IsTokenEnd(const char* p) const {
  return p == end_ || IsBlank(*p) || IsLineEnd(*p) || (dialect_.comment != 0 && *p == dialect_.comment);
}

void TextScanner::PassBlanks() {
  for (;;) {
    while (at_ < end_ && IsBlank(*at_)) ++at_;
    if (!dialect_.continued || end_ - at_ < 2 || *at_ != '\\' || !IsLineEnd(at_[1])) return;
    at_ += (end_ - at_ > 2 && at_[1] == '\r' && at_[2] == '\n') ? 3 : 2;
    ++line_;
  }
}

bool TextScanner::AtLineEnd() {
  PassBlanks();
  return at_ == end_ || IsLineEnd(*at_) || (dialect_.comment != 0 && *at_ == dialect_.comment);
}

void TextScanner::SkipLine() {
  // memchr makes long comments cheap. The next LF is remembered: in a text with CR line ends it may be far away.
  if (next_lf_ == nullptr || next_lf_ < at_) {
    const void* lf = std::memchr(at_, '\n', end_ - at_);
    next_lf_ = lf != nullptr ? static_cast<const char*>(lf) : end_;
  }
  const char* stop = next_lf_;
  const void* cr = std::memchr(at_, '\r', stop - at_);
  if (cr != nullptr && static_cast<const char*>(cr) + 1 != stop) stop = static_cast<const char*>(cr);
  at_ = stop;
  if (at_ == end_) return;
  ++at_;
  ++line_;
}

bool TextScanner::SkipToContent() {
  while (AtLineEnd()) {
    if (at_ == end_) return false;
    SkipLine();
  }
  return true;
}

std::string_view TextScanner::Peek() {
  if (AtLineEnd()) return {};
  const char* p = at_ + 1;
  while (!IsTokenEnd(p)) ++p;
  return {at_, static_cast<size_t>(p - at_)};
}

std::string_view TextScanner::Token() {
  const std::string_view token = Peek();
  at_ += token.size();
  return token;
}

std::string_view TextScanner::RestOfLine() {
  PassBlanks();
  const char* start = at_;
  while (at_ < end_ && !IsLineEnd(*at_)) ++at_;
  const char* stop = at_;
  while (stop > start && IsBlank(stop[-1])) --stop;
  return {start, static_cast<size_t>(stop - start)};
}

bool TextScanner::ReadDouble(double& value) {
  PassBlanks();
  const char* start = at_;
  if (start < end_ && *start == '+' && end_ - start > 1 && start[1] != '-') ++start;
  const auto [stop, error] = std::from_chars(start, end_, value);
  if (error == std::errc::invalid_argument || !IsTokenEnd(stop)) return false;
  if (error == std::errc::result_out_of_range) value = BeyondRange(start, stop);
  at_ = stop;
  return true;
}

bool TextScanner::ReadLeadingInt(int64_t& value) {
  PassBlanks();
  const char* start = at_;
  if (start < end_ && *start == '+' && end_ - start > 1 && start[1] != '-') ++start;
  const auto [stop, error] = std::from_chars(start, end_, value);
  if (error != std::errc()) return false;
  at_ = stop;
  return true;
}

bool TextScanner::ReadInt(int64_t& value) {
  PassBlanks();
  const char* const start = at_;
  if (ReadLeadingInt(value) && IsTokenEnd(at_)) return true;
  at_ = start;
  return false;
}

}  // namespace meshfront
