// Where writers put their bytes: through a small buffer into a string or a file, plain or gzip-compressed.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <type_traits>

#include "absl/status/status.h"

namespace meshfront {

// Takes whole blocks. Implemented by the string, file and gzip sinks of this room.
class ByteSink {
 public:
  virtual ~ByteSink() = default;
  virtual absl::Status Append(std::string_view bytes) = 0;
};

class StringSink : public ByteSink {
 public:
  absl::Status Append(std::string_view bytes) override;
  std::string Take() { return std::move(text_); }

 private:
  std::string text_;
};

// The writer's pen. The first failure of the sink is kept and everything after it ignored, so writers look once, at Finish.
class Output {
 public:
  explicit Output(ByteSink& sink) : sink_(sink) { buffer_.reserve(kBlock); }

  void Text(std::string_view text) {
    if (buffer_.size() + text.size() > kBlock) Flush();
    if (text.size() > kBlock)
      Pass(text);
    else
      buffer_.append(text);
  }
  void Number(double value);  // the shortest text that reads back to the same double; "nan", "inf"
  void Number(uint64_t value);
  // "x y z", each as above.
  template <class Vector>
  void Triple(const Vector& v) {
    Number(v.x), Text(" "), Number(v.y), Text(" "), Number(v.z);
  }
  // The value's bytes as they lie in memory; every machine we build for is little-endian, and so are the formats.
  template <class T>
  void Raw(const T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    Text({reinterpret_cast<const char*>(&value), sizeof(T)});
  }
  absl::Status Finish() {
    Flush();
    return status_;
  }

 private:
  static constexpr size_t kBlock = 64 << 10;
  void Flush();
  void Pass(std::string_view bytes) {
    if (status_.ok()) status_ = sink_.Append(bytes);
  }

  ByteSink& sink_;
  std::string buffer_;
  absl::Status status_;
};

}  // namespace meshfront
