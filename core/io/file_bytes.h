// Whole files: read into one buffer, written to a temporary name and renamed.
#pragma once

#include <cstdint>
#include <cstdlib>
#include <functional>
#include <memory>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/types/span.h"
#include "core/io/output.h"

namespace meshfront {

// Bytes on the heap that can grow in place (large blocks are moved by the kernel, not copied) and are not zeroed. Movable.
class ByteBuffer {
 public:
  // False, and unchanged, when there is no memory.
  bool Resize(uint64_t size);
  uint8_t* data() { return bytes_.get(); }
  uint64_t size() const { return size_; }
  absl::Span<const uint8_t> span() const { return {bytes_.get(), static_cast<size_t>(size_)}; }

 private:
  struct Free {
    void operator()(uint8_t* bytes) const { std::free(bytes); }
  };
  std::unique_ptr<uint8_t, Free> bytes_;
  uint64_t size_ = 0;
};

// NotFound when it can't be opened (or is a folder), InvalidArgument when it is longer than `limit`. Pipes are read to their end.
// A buffer rather than a mapping: a file that shrinks while it is read must not end the process.
absl::StatusOr<ByteBuffer> ReadWholeFile(const std::string& path, uint64_t limit);

// Runs `write` on a sink and puts what it wrote in place of `path` (see WriteMeshFile for the promises). When `write` fails, its
// status is returned and nothing has changed.
absl::Status ReplaceFile(const std::string& path, const std::function<absl::Status(ByteSink&)>& write);

}  // namespace meshfront
