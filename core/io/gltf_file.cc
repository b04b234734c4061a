#include "core/io/gltf_file.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "core/base/status_macros.h"
#include "core/io/base64.h"

namespace meshfront {
namespace {

constexpr uint32_t kJsonChunk = 0x4e4f534a, kBinaryChunk = 0x004e4942;  // "JSON", "BIN\0"
enum ComponentType {
  kByte = 5120,
  kUnsignedByte = 5121,
  kShort = 5122,
  kUnsignedShort = 5123,
  kUnsignedInt = 5125,
  kFloat = 5126
};

int ComponentBytes(uint64_t type) {
  switch (type) {
    case kByte:
    case kUnsignedByte:
      return 1;
    case kShort:
    case kUnsignedShort:
      return 2;
    case kUnsignedInt:
    case kFloat:
      return 4;
    default:
      return 0;
  }
}

int ComponentCount(JsonValue type) {
  if (type.Equals("SCALAR")) return 1;
  if (type.Equals("VEC2")) return 2;
  if (type.Equals("VEC3")) return 3;
  if (type.Equals("VEC4")) return 4;
  return 0;
}

template <class T>
T Load(const uint8_t* at) {
  T value;
  std::memcpy(&value, at, sizeof(T));
  return value;
}

// Extensions that change how a picture looks, or are read here.
bool IsHarmless(const std::string& extension) {
  if (extension == "KHR_mesh_quantization") return true;
  for (const char* prefix : {"KHR_materials_", "KHR_texture_", "EXT_texture_", "KHR_lights_", "KHR_xmp"}) {
    if (absl::StartsWith(extension, prefix)) return true;
  }
  return false;
}

// "%20" and the like; false when the escape is cut or names a zero byte.
bool PercentDecode(std::string_view text, std::string& out) {
  for (size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '%') {
      out.push_back(text[i]);
      continue;
    }
    const std::string hex(text.substr(i + 1, 2));
    if (hex.size() < 2 || !absl::ascii_isxdigit(hex[0]) || !absl::ascii_isxdigit(hex[1]) || hex == "00") return false;
    out.push_back(static_cast<char>(std::strtol(hex.c_str(), nullptr, 16)));
    i += 2;
  }
  return true;
}

std::string RealPath(const std::string& path) {
  char* real = ::realpath(path.c_str(), nullptr);
  std::string result = real != nullptr ? real : "";
  std::free(real);
  return result;
}

}  // namespace

double GltfAccessor::ComponentAt(const uint8_t* at) const {
  double value = 0, largest = 1;
  switch (component_type) {
    case kByte:
      value = Load<int8_t>(at), largest = 127;
      break;
    case kUnsignedByte:
      value = *at, largest = 255;
      break;
    case kShort:
      value = Load<int16_t>(at), largest = 32767;
      break;
    case kUnsignedShort:
      value = Load<uint16_t>(at), largest = 65535;
      break;
    case kUnsignedInt:
      value = Load<uint32_t>(at), largest = 4294967295.0;
      break;
    default:
      return Load<float>(at);
  }
  return normalized ? std::max(value / largest, -1.0) : value;
}

Vec3 GltfAccessor::VectorAt(uint64_t i) const {
  const uint8_t* at = data + i * stride;
  const int size = ComponentBytes(component_type);
  return {ComponentAt(at), ComponentAt(at + size), ComponentAt(at + 2 * size)};
}

double GltfAccessor::NumberAt(uint64_t i, int c) const {
  return ComponentAt(data + i * stride + c * ComponentBytes(component_type));
}

uint32_t GltfAccessor::IndexAt(uint64_t i) const {
  const uint8_t* at = data + i * stride;
  if (component_type == kUnsignedByte) return *at;
  return component_type == kUnsignedShort ? Load<uint16_t>(at) : Load<uint32_t>(at);
}

absl::StatusOr<std::unique_ptr<GltfFile>> GltfFile::OpenGlb(const Source& source) {
  const absl::Span<const uint8_t> bytes = source.bytes;
  if (bytes.size() < 20 || source.text().substr(0, 4) != "glTF") {
    return Refuse(source, "byte 0: is no GLB file: it must begin with \"glTF\" and have a header of 20 bytes, and has ",
                  bytes.size(), " bytes");
  }
  const uint32_t version = Load<uint32_t>(bytes.data() + 4), length = Load<uint32_t>(bytes.data() + 8);
  if (version != 2) return Refuse(source, "byte 4: the container's version is ", version, "; only 2 is known");
  if (length > bytes.size()) {
    return Refuse(source, "byte 8: the header says ", length, " bytes, but the file has ", bytes.size());
  }
  auto file = std::unique_ptr<GltfFile>(new GltfFile(source));
  std::string_view json;
  for (uint64_t at = 12, chunk = 0; at < length; ++chunk) {
    if (length - at < 8) return Refuse(source, "byte ", at, ": the file ends inside a chunk's header");
    const uint32_t size = Load<uint32_t>(bytes.data() + at), kind = Load<uint32_t>(bytes.data() + at + 4);
    at += 8;
    if (size > length - at) {
      return Refuse(source, "byte ", at - 8, ": a chunk says ", size, " bytes, but only ", length - at, " follow");
    }
    if ((chunk == 0) != (kind == kJsonChunk))
      return Refuse(source, "byte ", at - 4, ": the first chunk, and no other, must be JSON");
    if (kind == kJsonChunk) json = source.text().substr(at, size);
    if (kind == kBinaryChunk && !file->has_binary_) file->binary_ = bytes.subspan(at, size), file->has_binary_ = true;
    at += size;
  }
  MESHFRONT_RETURN_IF_ERROR(file->Open(json));
  return file;
}

absl::StatusOr<std::unique_ptr<GltfFile>> GltfFile::OpenGltf(const Source& source) {
  auto file = std::unique_ptr<GltfFile>(new GltfFile(source));
  std::string_view text = source.text();
  if (text.substr(0, 3) == "\xef\xbb\xbf") text.remove_prefix(3);
  MESHFRONT_RETURN_IF_ERROR(file->Open(text));
  return file;
}

absl::Status GltfFile::Open(std::string_view json) {
  MESHFRONT_ASSIGN_OR_RETURN(document_, JsonDocument::Parse(source_, json));
  if (!root().is_object()) return Refuse(source_, "the JSON is no object");
  const std::string version = root().Find("asset").Find("version").String();
  if (version.substr(0, 2) != "2.") {
    return Refuse(source_, "asset.version is ", Quote(version), "; only 2.x is known");
  }
  for (const std::string_view name : {"accessors", "bufferViews", "buffers", "meshes", "nodes", "scenes", "images",
                                      "skins", "animations", "materials"}) {
    std::vector<uint32_t>& elements = arrays_[std::string(name)];
    const JsonValue array = root().Find(name);
    elements.reserve(array.is_array() ? array.size() : 0);
    if (!array.is_array()) continue;
    for (JsonValue v = array.First(); v.exists(); v = v.Next()) elements.push_back(v.node());
  }
  return CheckExtensions();
}

absl::Status GltfFile::CheckExtensions() {
  for (JsonValue v = root().Find("extensionsRequired").First(); v.exists(); v = v.Next()) {
    if (!IsHarmless(v.String())) return Refuse(source_, "requires the extension ", v.Excerpt(), ", which is not read");
  }
  return absl::OkStatus();
}

JsonValue GltfFile::Element(std::string_view array, uint64_t index) {
  const std::vector<uint32_t>& elements = arrays_.find(array)->second;
  return index < elements.size() ? document_.At(elements[index]) : JsonValue();
}

uint64_t GltfFile::Count(std::string_view array) { return arrays_.find(array)->second.size(); }

absl::StatusOr<const GltfAccessor*> GltfFile::Accessor(JsonValue index, const std::string& where) {
  const std::optional<uint64_t> number = index.Integer();
  if (!number || *number >= Count("accessors")) {
    return Refuse(source_, where, " names accessor ", index.Excerpt(), "; there are ", Count("accessors"));
  }
  return ReadAccessor(*number);
}

absl::StatusOr<const GltfAccessor*> GltfFile::ReadAccessor(uint64_t index) {
  std::unique_ptr<GltfAccessor>& kept = accessors_[index];
  if (kept != nullptr) return kept.get();
  auto accessor = std::make_unique<GltfAccessor>();
  MESHFRONT_RETURN_IF_ERROR(FillAccessor(Element("accessors", index), Concat("accessors[", index, "]"), *accessor));
  kept = std::move(accessor);
  return kept.get();
}

absl::Status GltfFile::FillAccessor(JsonValue json, const std::string& where, GltfAccessor& accessor) {
  const JsonValue type = json.Find("type"), component_type = json.Find("componentType"), count = json.Find("count");
  const int component_bytes = ComponentBytes(component_type.Integer().value_or(0));
  accessor.components = ComponentCount(type);
  if (component_bytes == 0)
    return Refuse(source_, where, ".componentType is ", component_type.Excerpt(), ", which is no type");
  if (accessor.components == 0) return Refuse(source_, where, ".type is ", type.Excerpt(), "; SCALAR to VEC4 are read");
  if (count.Integer().value_or(0) == 0)
    return Refuse(source_, where, ".count is ", count.Excerpt(), "; it must be at least 1");
  accessor.component_type = static_cast<int>(*component_type.Integer());
  accessor.count = *count.Integer();
  accessor.normalized = json.Find("normalized").Raw() == "true";
  const JsonValue sparse = json.Find("sparse");
  if (json.Find("bufferView").exists()) {
    const uint64_t size = uint64_t(component_bytes) * accessor.components;
    MESHFRONT_RETURN_IF_ERROR(Locate(json, where, size, accessor));
  } else if (!sparse.exists()) {
    return Refuse(source_, where, " has neither a bufferView nor sparse values");
  }
  return sparse.exists() ? ApplySparse(sparse, where, accessor) : absl::OkStatus();
}

// A copy without gaps, zero where there is no bufferView, in which the listed elements are replaced.
absl::Status GltfFile::ApplySparse(JsonValue sparse, const std::string& where, GltfAccessor& accessor) {
  const uint64_t size = uint64_t(ComponentBytes(accessor.component_type)) * accessor.components;
  if (accessor.count > total_bytes() / size + 1024) {
    return Refuse(source_, where, ".count is ", accessor.count, ", more than a sparse accessor in a file of ",
                  total_bytes(), " bytes may have");
  }
  ByteBuffer dense;
  if (!dense.Resize(accessor.count * size)) return absl::ResourceExhaustedError("no memory for a sparse accessor");
  for (uint64_t i = 0; i < accessor.count; ++i) {
    if (accessor.data != nullptr)
      std::memcpy(dense.data() + i * size, accessor.data + i * accessor.stride, size);
    else
      std::memset(dense.data() + i * size, 0, size);
  }
  GltfAccessor indices, values;
  const JsonValue type = sparse.Find("indices").Find("componentType");
  indices.component_type = static_cast<int>(type.Integer().value_or(0));
  if (indices.component_type != kUnsignedByte && indices.component_type != kUnsignedShort &&
      indices.component_type != kUnsignedInt) {
    return Refuse(source_, where, ".sparse.indices.componentType is ", type.Excerpt(), "; it must be unsigned");
  }
  indices.count = values.count = sparse.Find("count").Integer().value_or(0);
  if (indices.count == 0 || indices.count > accessor.count) {
    return Refuse(source_, where, ".sparse.count is ", sparse.Find("count").Excerpt(), "; it must be 1 to ",
                  accessor.count);
  }
  MESHFRONT_RETURN_IF_ERROR(
      Locate(sparse.Find("indices"), where + ".sparse.indices", ComponentBytes(indices.component_type), indices));
  MESHFRONT_RETURN_IF_ERROR(Locate(sparse.Find("values"), where + ".sparse.values", size, values));
  for (uint64_t i = 0; i < indices.count; ++i) {
    const uint32_t at = indices.IndexAt(i);
    if (at >= accessor.count) return Refuse(source_, where, ".sparse names element ", at, " of ", accessor.count);
    std::memcpy(dense.data() + at * size, values.data + i * values.stride, size);
  }
  accessor.data = dense.data(), accessor.stride = size;
  sparse_.push_back(std::move(dense));
  return absl::OkStatus();
}

absl::Status GltfFile::Locate(JsonValue json, const std::string& where, uint64_t size, GltfAccessor& accessor) {
  const JsonValue view = json.Find("bufferView"), offset_value = json.Find("byteOffset");
  const uint64_t views = Count("bufferViews");
  if (view.Integer().value_or(views) >= views) {
    return Refuse(source_, where, ".bufferView is ", view.Excerpt(), "; there are ", views);
  }
  uint64_t stride = 0;
  MESHFRONT_ASSIGN_OR_RETURN(const absl::Span<const uint8_t> bytes, ViewBytes(*view.Integer(), stride));
  if (offset_value.exists() && !offset_value.Integer())
    return Refuse(source_, where, ".byteOffset is ", offset_value.Excerpt());
  const uint64_t offset = offset_value.Integer().value_or(0);
  accessor.stride = stride == 0 ? size : stride;
  if (accessor.stride < size) {
    return Refuse(source_, where, ": bufferViews[", *view.Integer(), "].byteStride is ", stride,
                  ", less than an element's ", size, " bytes");
  }
  // offset + stride · (count − 1) + size ≤ bytes, without overflow.
  if (offset > bytes.size() || bytes.size() - offset < size ||
      (bytes.size() - offset - size) / accessor.stride < accessor.count - 1) {
    return Refuse(source_, where, ": ", accessor.count, " elements of ", size, " bytes from byte ", offset,
                  " do not fit into the ", bytes.size(), " bytes of bufferViews[", *view.Integer(), "]");
  }
  accessor.data = bytes.data() + offset;
  return absl::OkStatus();
}

absl::StatusOr<absl::Span<const uint8_t>> GltfFile::ViewBytes(uint64_t index, uint64_t& stride) {
  const JsonValue json = Element("bufferViews", index);
  const std::string where = Concat("bufferViews[", index, "]");
  const JsonValue buffer = json.Find("buffer"), offset_value = json.Find("byteOffset"),
                  length_value = json.Find("byteLength");
  if (buffer.Integer().value_or(Count("buffers")) >= Count("buffers")) {
    return Refuse(source_, where, ".buffer is ", buffer.Excerpt(), "; there are ", Count("buffers"));
  }
  if (!length_value.Integer()) return Refuse(source_, where, ".byteLength is ", length_value.Excerpt());
  if (offset_value.exists() && !offset_value.Integer())
    return Refuse(source_, where, ".byteOffset is ", offset_value.Excerpt());
  const JsonValue stride_value = json.Find("byteStride");
  if (stride_value.exists() && !stride_value.Integer())
    return Refuse(source_, where, ".byteStride is ", stride_value.Excerpt());
  stride = stride_value.Integer().value_or(0);
  MESHFRONT_ASSIGN_OR_RETURN(const absl::Span<const uint8_t> bytes, BufferBytes(*buffer.Integer()));
  const uint64_t offset = offset_value.Integer().value_or(0), length = *length_value.Integer();
  if (offset > bytes.size() || length > bytes.size() - offset) {
    return Refuse(source_, where, ": bytes ", offset, " to ", offset, " + ", length, " do not lie in buffers[",
                  *buffer.Integer(), "], which has ", bytes.size());
  }
  return bytes.subspan(offset, length);
}

absl::StatusOr<absl::Span<const uint8_t>> GltfFile::View(uint64_t index) {
  uint64_t stride = 0;
  return ViewBytes(index, stride);
}

absl::StatusOr<absl::Span<const uint8_t>> GltfFile::BufferBytes(uint64_t index) {
  if (const auto known = buffers_.find(index); known != buffers_.end()) return known->second.bytes;
  const JsonValue json = Element("buffers", index), length_value = json.Find("byteLength");
  const std::string where = Concat("buffers[", index, "]");
  if (!length_value.Integer()) return Refuse(source_, where, ".byteLength is ", length_value.Excerpt());
  const uint64_t length = *length_value.Integer();
  Buffer buffer;
  if (json.Find("uri").exists()) {
    MESHFRONT_RETURN_IF_ERROR(LoadBuffer(json, where, length, buffer));
    buffer.bytes = buffer.owned.span();
    buffer_bytes_ += buffer.bytes.size();
  } else if (index == 0 && has_binary_) {
    buffer.bytes = binary_;
  } else {
    return Refuse(source_, where, " has no uri, and no BIN chunk belongs to it");
  }
  if (buffer.bytes.size() < length) {
    return Refuse(source_, where, ".byteLength is ", length, ", but its data has ", buffer.bytes.size(), " bytes");
  }
  buffer.bytes = buffer.bytes.subspan(0, length);
  return buffers_.emplace(index, std::move(buffer)).first->second.bytes;
}

absl::Status GltfFile::LoadBuffer(JsonValue json, const std::string& where, uint64_t length, Buffer& buffer) {
  const JsonValue uri = json.Find("uri");
  const bool escaped = uri.Raw().find('\\') != std::string_view::npos;
  const std::string unescaped = escaped ? uri.String() : "";
  const std::string_view text = escaped ? std::string_view(unescaped) : uri.Raw();
  const uint64_t limit = source_.limits.max_decompressed_bytes;
  if (length > limit || total_bytes() > limit - length)
    return Refuse(source_, where, ": all buffers together pass the limit of ", limit, " bytes");
  if (text.substr(0, 5) == "data:") {
    const size_t comma = text.find(',');
    if (comma == std::string_view::npos || text.substr(0, comma).find(";base64") == std::string_view::npos ||
        !DecodeBase64(text.substr(comma + 1), buffer.owned)) {
      return Refuse(source_, where, ".uri is a data uri, but not sound base64");
    }
    return absl::OkStatus();
  }
  MESHFRONT_ASSIGN_OR_RETURN(const std::string path, InsideFolder(std::string(text), where));
  absl::StatusOr<ByteBuffer> bytes = ReadWholeFile(path, limit - total_bytes());
  if (!bytes.ok()) return Refuse(source_, where, ".uri: ", std::string(bytes.status().message()));
  buffer.owned = *std::move(bytes);
  return absl::OkStatus();
}

// Relative, without a scheme or steps upwards, and after following links still below the base folder.
absl::StatusOr<std::string> GltfFile::InsideFolder(const std::string& uri, const std::string& where) {
  std::string path;
  const bool sound = PercentDecode(uri, path) && !path.empty() && path[0] != '/' &&
                     path.find('\0') == std::string::npos && path.find_first_of(":\\") == std::string::npos;
  const std::string steps = "/" + path + "/";
  if (!sound || steps.find("/../") != std::string::npos) {
    return Refuse(source_, where, ".uri is ", Quote(uri),
                  "; only files inside the folder of the glTF file may be named");
  }
  if (source_.base_folder.empty()) {
    return Refuse(source_, where, ".uri is ", Quote(uri),
                  "; no other file may be opened here, so use GLB or embed the buffer");
  }
  const std::string folder = RealPath(source_.base_folder), real = RealPath(source_.base_folder + "/" + path);
  if (real.empty()) return Refuse(source_, where, ".uri is ", Quote(uri), "; there is no such file");
  if (!absl::StartsWith(real, folder == "/" ? "/" : folder + "/")) {
    return Refuse(source_, where, ".uri is ", Quote(uri), ", a link that leaves the folder of the glTF file");
  }
  return real;
}

}  // namespace meshfront
