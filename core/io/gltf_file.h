// A glTF file taken apart: container, JSON, buffers, accessors; every size checked in 64 bits.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <vector>

#include "absl/container/flat_hash_map.h"
#include "absl/status/statusor.h"
#include "absl/types/span.h"
#include "core/geometry/vec3.h"
#include "core/io/file_bytes.h"
#include "core/io/json.h"
#include "core/io/source.h"

namespace meshfront {

// Elements of `components` numbers each, all inside their buffer.
struct GltfAccessor {
  const uint8_t* data = nullptr;
  uint64_t count = 0, stride = 0;
  int component_type = 0, components = 0;
  bool normalized = false;

  // Element i < count of an accessor of three or more components; normalised integers come out in [-1, 1].
  Vec3 VectorAt(uint64_t i) const;
  // Of an accessor of unsigned integers.
  uint32_t IndexAt(uint64_t i) const;
  // Number c < components of element i.
  double NumberAt(uint64_t i, int c) const;

 private:
  double ComponentAt(const uint8_t* at) const;
};

class GltfFile {
 public:
  // `source` must outlive the file. InvalidArgument for a broken container, JSON, version, or a required extension that changes
  // geometry in ways we don't know.
  static absl::StatusOr<std::unique_ptr<GltfFile>> OpenGlb(const Source& source);
  static absl::StatusOr<std::unique_ptr<GltfFile>> OpenGltf(const Source& source);

  JsonValue root() const { return document_.root(); }
  const JsonDocument& document() const { return document_; }
  // Element `index` of a top-level array; nothing when it has no such element.
  JsonValue Element(std::string_view array, uint64_t index);
  uint64_t Count(std::string_view array);

  // Checked once, then kept. `index` is the JSON value that names it, `where` begins the message.
  absl::StatusOr<const GltfAccessor*> Accessor(JsonValue index, const std::string& where);
  // The bytes of a buffer view.
  absl::StatusOr<absl::Span<const uint8_t>> View(uint64_t index);
  // Bytes of the file and of all buffers read so far.
  uint64_t total_bytes() const { return source_.bytes.size() + buffer_bytes_; }

 private:
  struct Buffer {
    absl::Span<const uint8_t> bytes;
    ByteBuffer owned;
  };

  explicit GltfFile(const Source& source) : source_(source) {}
  absl::Status Open(std::string_view json);
  absl::Status CheckExtensions();
  absl::StatusOr<const GltfAccessor*> ReadAccessor(uint64_t index);
  absl::Status FillAccessor(JsonValue json, const std::string& where, GltfAccessor& accessor);
  absl::Status ApplySparse(JsonValue sparse, const std::string& where, GltfAccessor& accessor);
  // `count` elements of `size` bytes at `byteOffset` of what `json` calls its bufferView; sets data and stride.
  absl::Status Locate(JsonValue json, const std::string& where, uint64_t size, GltfAccessor& accessor);
  absl::StatusOr<absl::Span<const uint8_t>> ViewBytes(uint64_t index, uint64_t& stride);
  absl::StatusOr<absl::Span<const uint8_t>> BufferBytes(uint64_t index);
  absl::Status LoadBuffer(JsonValue json, const std::string& where, uint64_t length, Buffer& buffer);
  absl::StatusOr<std::string> InsideFolder(const std::string& uri, const std::string& where);

  const Source& source_;
  JsonDocument document_;
  absl::Span<const uint8_t> binary_;  // the BIN chunk
  bool has_binary_ = false;
  std::map<std::string, std::vector<uint32_t>, std::less<>> arrays_;  // JSON nodes of the elements
  std::map<uint64_t, Buffer> buffers_;
  absl::flat_hash_map<uint64_t, std::unique_ptr<GltfAccessor>> accessors_;
  std::vector<ByteBuffer> sparse_;
  uint64_t buffer_bytes_ = 0;
};

}  // namespace meshfront
