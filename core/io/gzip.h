// gzip: recognised by content, inflated under a limit, written as one member.
#pragma once

#include <cstdint>
#include <memory>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/types/span.h"
#include "core/io/file_bytes.h"
#include "core/io/output.h"
#include "core/io/source.h"

namespace meshfront {

bool IsGzip(absl::Span<const uint8_t> bytes);
// All members, one after the other (zero bytes may follow the last). InvalidArgument when the data is cut or damaged, when
// something else follows, or when more than `source.limits.max_decompressed_bytes` come out.
absl::StatusOr<ByteBuffer> Inflate(const Source& source);

// Compresses what it is given into another sink; Finish ends the member.
class GzipSink : public ByteSink {
 public:
  explicit GzipSink(ByteSink& next);
  ~GzipSink() override;
  absl::Status Append(std::string_view bytes) override;
  absl::Status Finish();

 private:
  struct State;
  absl::Status Deflate(std::string_view bytes, int flush);
  ByteSink& next_;
  std::unique_ptr<State> state_;
};

}  // namespace meshfront
