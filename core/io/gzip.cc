#include "core/io/gzip.h"

#include <zlib.h>

#include <algorithm>
#include <limits>

#include "core/base/status_macros.h"

namespace meshfront {
namespace {

constexpr int kGzipWindow = 15 + 16;       // zlib: the largest window, gzip framing
constexpr uint64_t kMostExpansion = 1032;  // what deflate can make of one byte at most

// zlib counts in 32 bits.
uInt AtMost32(uint64_t count) { return static_cast<uInt>(std::min<uint64_t>(count, 1u << 30)); }

struct InflateStream {
  z_stream z = {};
  bool ready = false;
  InflateStream() { ready = inflateInit2(&z, kGzipWindow) == Z_OK; }
  ~InflateStream() { inflateEnd(&z); }
};

// Room for more output: twice the old size, within what the limit, the reader's budget and the rest of the input allow.
absl::Status Grow(const Source& source, ByteBuffer& out, uint64_t used, uint64_t limit, uint64_t compressed_left) {
  const uint64_t possible = used + std::min(limit - used, compressed_left * kMostExpansion + (64 << 10));
  const uint64_t size = std::min<uint64_t>(possible, std::max<uint64_t>(2 * used, 64 << 10));
  if (source.limits.admit) MESHFRONT_RETURN_IF_ERROR(source.limits.admit(size));
  if (size > used && out.Resize(size)) return absl::OkStatus();
  return absl::ResourceExhaustedError(absl::StrCat(source.name, ": no memory for ", used, " decompressed bytes"));
}

bool IsAllZero(absl::Span<const uint8_t> bytes) {
  return std::all_of(bytes.begin(), bytes.end(), [](uint8_t b) { return b == 0; });
}

}  // namespace

bool IsGzip(absl::Span<const uint8_t> bytes) { return bytes.size() >= 2 && bytes[0] == 0x1f && bytes[1] == 0x8b; }

absl::StatusOr<ByteBuffer> Inflate(const Source& source) {
  InflateStream stream;
  if (!stream.ready) return absl::ResourceExhaustedError(absl::StrCat(source.name, ": no memory to decompress"));
  // One byte past the limit tells a file that fits exactly from one that does not.
  const uint64_t limit = std::min(source.limits.max_decompressed_bytes, std::numeric_limits<uint64_t>::max() - 1) + 1;
  ByteBuffer out;
  uint64_t used = 0, taken = 0;
  for (;;) {
    if (used == out.size()) MESHFRONT_RETURN_IF_ERROR(Grow(source, out, used, limit, source.bytes.size() - taken));
    stream.z.next_in = const_cast<Bytef*>(source.bytes.data() + taken);
    stream.z.avail_in = AtMost32(source.bytes.size() - taken);
    stream.z.next_out = out.data() + used;
    stream.z.avail_out = AtMost32(out.size() - used);
    const int result = inflate(&stream.z, Z_NO_FLUSH);
    taken = stream.z.next_in - source.bytes.data();
    used = stream.z.next_out - out.data();
    if (used >= limit) {
      return Refuse(source, "decompresses to more than ", limit - 1, " bytes, which is the limit");
    }
    if (result == Z_STREAM_END) {
      const absl::Span<const uint8_t> rest = source.bytes.subspan(taken);
      if (IsAllZero(rest)) break;
      if (!IsGzip(rest)) return Refuse(source, "byte ", taken, " of the gzip data begins something that is not gzip");
      inflateReset(&stream.z);
    } else if (result == Z_BUF_ERROR && taken == source.bytes.size()) {
      return Refuse(source, "the gzip data is cut: it ends after ", taken, " bytes in the middle of a member");
    } else if (result != Z_OK && result != Z_BUF_ERROR) {
      return Refuse(source, "the gzip data is damaged near byte ", taken, " (",
                    stream.z.msg ? stream.z.msg : "zlib error", ")");
    }
  }
  out.Resize(used);
  return out;
}

struct GzipSink::State {
  z_stream z = {};
  std::string block = std::string(64 << 10, '\0');
};

GzipSink::GzipSink(ByteSink& next) : next_(next), state_(std::make_unique<State>()) {
  deflateInit2(&state_->z, Z_DEFAULT_COMPRESSION, Z_DEFLATED, kGzipWindow, 8, Z_DEFAULT_STRATEGY);
}
GzipSink::~GzipSink() { deflateEnd(&state_->z); }

absl::Status GzipSink::Append(std::string_view bytes) {
  for (; !bytes.empty(); bytes.remove_prefix(AtMost32(bytes.size()))) {
    MESHFRONT_RETURN_IF_ERROR(Deflate(bytes.substr(0, AtMost32(bytes.size())), Z_NO_FLUSH));
  }
  return absl::OkStatus();
}

absl::Status GzipSink::Finish() { return Deflate({}, Z_FINISH); }

absl::Status GzipSink::Deflate(std::string_view bytes, int flush) {
  z_stream& z = state_->z;
  z.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  z.avail_in = static_cast<uInt>(bytes.size());
  do {
    z.next_out = reinterpret_cast<Bytef*>(state_->block.data());
    z.avail_out = static_cast<uInt>(state_->block.size());
    if (deflate(&z, flush) == Z_STREAM_ERROR) return absl::InternalError("zlib refuses to compress");
    MESHFRONT_RETURN_IF_ERROR(next_.Append({state_->block.data(), state_->block.size() - z.avail_out}));
  } while (z.avail_out == 0);
  return absl::OkStatus();
}

}  // namespace meshfront
