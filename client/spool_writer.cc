#include "client/spool_writer.h"

#include <array>
#include <charconv>
#include <cstring>
#include <nlohmann/json.hpp>
#include <string>

#include "absl/strings/str_cat.h"
#include "core/base/status_macros.h"
#include "core/geometry/triangle.h"

namespace meshfront {
namespace {

using Json = nlohmann::json;
using Vertices = absl::Span<const SpooledVertex>;
using Triangles = absl::Span<const Triangle>;

// The shortest decimals that read back as the same number.
void AppendNumber(double value, std::string* text) {
  char digits[32];
  const std::to_chars_result end = std::to_chars(digits, digits + sizeof(digits), value);
  text->append(digits, end.ptr - digits);
}

void AppendFloat(double value, std::string* bytes) {
  const float f = static_cast<float>(value);
  bytes->append(reinterpret_cast<const char*>(&f), sizeof(f));
}

void AppendVec3(const Vec3& v, std::string* bytes) {
  AppendFloat(v.x, bytes), AppendFloat(v.y, bytes), AppendFloat(v.z, bytes);
}

// Each triangle as text: `prefix`, then its vertex ids plus `base`.
absl::Status WriteTriangleLines(const ChunkSpool& spool, absl::string_view prefix, uint32_t base, ByteSink& file) {
  return spool.ForEachTriangleBlock([&](Triangles block) {
    std::string lines;
    for (const Triangle& t : block) {
      absl::StrAppend(&lines, prefix, t[0].index() + base, " ", t[1].index() + base, " ", t[2].index() + base, "\n");
    }
    return file.Append(lines);
  });
}

absl::Status WriteVertexLines(const ChunkSpool& spool, absl::string_view prefix, ByteSink& file) {
  return spool.ForEachVertexBlock([&](Vertices block) {
    std::string lines;
    for (const SpooledVertex& v : block) {
      lines.append(prefix.data(), prefix.size());
      for (int axis = 0; axis < 3; ++axis) {
        AppendNumber(v.position[axis], &lines);
        lines += axis < 2 ? ' ' : '\n';
      }
    }
    return file.Append(lines);
  });
}

absl::Status WriteOff(const ChunkSpool& spool, ByteSink& file) {
  MESHFRONT_RETURN_IF_ERROR(
      file.Append(absl::StrCat("OFF\n", spool.vertex_count(), " ", spool.triangle_count(), " 0\n")));
  MESHFRONT_RETURN_IF_ERROR(WriteVertexLines(spool, "", file));
  return WriteTriangleLines(spool, "3 ", 0, file);
}

absl::Status WriteObj(const ChunkSpool& spool, ByteSink& file) {
  MESHFRONT_RETURN_IF_ERROR(WriteVertexLines(spool, "v ", file));
  return WriteTriangleLines(spool, "f ", 1, file);
}

absl::Status WritePly(const ChunkSpool& spool, ByteSink& file) {
  MESHFRONT_RETURN_IF_ERROR(file.Append(
      absl::StrCat("ply\nformat binary_little_endian 1.0\ncomment meshfront\nelement vertex ", spool.vertex_count(),
                   "\nproperty double x\nproperty double y\nproperty double z\nelement face ", spool.triangle_count(),
                   "\nproperty list uchar int vertex_indices\nend_header\n")));
  MESHFRONT_RETURN_IF_ERROR(spool.ForEachVertexBlock([&](Vertices block) -> absl::Status {
    for (const SpooledVertex& v : block)
      MESHFRONT_RETURN_IF_ERROR(file.Append({reinterpret_cast<const char*>(&v.position), sizeof(v.position)}));
    return absl::OkStatus();
  }));
  return spool.ForEachTriangleBlock([&](Triangles block) -> absl::Status {
    for (const Triangle& t : block) {
      std::array<char, 13> record = {3};
      std::memcpy(record.data() + 1, t.data(), sizeof(t));
      MESHFRONT_RETURN_IF_ERROR(file.Append({record.data(), record.size()}));
    }
    return absl::OkStatus();
  });
}

absl::Status WriteStl(const ChunkSpool& spool, ByteSink& file) {
  std::string header(80, ' ');  // must not begin with "solid", which would announce text
  std::memcpy(header.data(), "meshfront", 9);
  const uint32_t count = static_cast<uint32_t>(spool.triangle_count());
  header.append(reinterpret_cast<const char*>(&count), sizeof(count));
  MESHFRONT_RETURN_IF_ERROR(file.Append(header));
  SpooledPositions positions(spool);
  return spool.ForEachTriangleBlock([&](Triangles block) -> absl::Status {
    for (const Triangle& t : block) {
      std::array<Vec3, 3> p;
      for (int i = 0; i < 3; ++i) {
        MESHFRONT_ASSIGN_OR_RETURN(p[i], positions.At(t[i]));
      }
      std::string record;
      AppendVec3(Normalized(AreaVector(p[0], p[1], p[2])), &record);
      for (const Vec3& corner : p) AppendVec3(corner, &record);
      record.append(2, '\0');
      MESHFRONT_RETURN_IF_ERROR(file.Append(record));
    }
    return absl::OkStatus();
  });
}

// Far from the origin float32 has no digits left for the shape: then the positions are relative to the centre of the mesh.
Vec3 GltfOrigin(const ChunkSpool& spool) {
  constexpr double far = 4;  // diagonals: two bits lost at most
  const Box3& box = spool.bounds();
  return !box.empty() && Norm(box.Center()) > far * box.Diagonal() ? box.Center() : Vec3{};
}

// The binary buffer of a glTF: positions, normals, indices, each a multiple of four bytes.
absl::Status ForEachBufferPart(const ChunkSpool& spool, const std::function<absl::Status(absl::string_view)>& body) {
  const Vec3 origin = GltfOrigin(spool);
  MESHFRONT_RETURN_IF_ERROR(spool.ForEachVertexBlock([&](Vertices block) {
    std::string bytes;
    for (const SpooledVertex& v : block) AppendVec3(v.position - origin, &bytes);
    return body(bytes);
  }));
  MESHFRONT_RETURN_IF_ERROR(spool.ForEachVertexBlock([&](Vertices block) {
    std::string bytes;
    for (const SpooledVertex& v : block) bytes.append(reinterpret_cast<const char*>(v.normal.data()), sizeof(v.normal));
    return body(bytes);
  }));
  return spool.ForEachTriangleBlock([&](Triangles block) {
    return body({reinterpret_cast<const char*>(block.data()), block.size() * sizeof(Triangle)});
  });
}

constexpr int kFloat = 5126, kUint32 = 5125, kArrayBuffer = 34962,
              kElementArrayBuffer = 34963;  // glTF's names for them

Json JsonOf(const Vec3& v) { return {v.x, v.y, v.z}; }
// Exactly what the buffer holds: rounding keeps the order, so the extremes stay the extremes.
Json FloatsOf(const Vec3& v) {
  return JsonOf({static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)});
}

Json GltfDocument(const ChunkSpool& spool, Json buffer) {
  const uint64_t vertices = spool.vertex_count(), triangles = spool.triangle_count();
  const uint64_t vertex_bytes = vertices * 12, index_bytes = triangles * 12;
  const Vec3 origin = GltfOrigin(spool);
  Json node = {{"mesh", 0}};
  if (origin != Vec3{}) node["translation"] = JsonOf(origin);
  Json primitive = {{"attributes", {{"POSITION", 0}, {"NORMAL", 1}}}, {"indices", 2}, {"mode", 4}};
  buffer["byteLength"] = 2 * vertex_bytes + index_bytes;
  return {{"asset", {{"version", "2.0"}, {"generator", "meshfront"}}},
          {"scene", 0},
          {"scenes", Json::array({Json{{"nodes", Json::array({0})}}})},
          {"nodes", Json::array({std::move(node)})},
          {"meshes", Json::array({Json{{"primitives", Json::array({std::move(primitive)})}}})},
          {"accessors",
           {{{"bufferView", 0},
             {"componentType", kFloat},
             {"count", vertices},
             {"type", "VEC3"},
             {"min", FloatsOf(spool.bounds().min - origin)},
             {"max", FloatsOf(spool.bounds().max - origin)}},
            {{"bufferView", 1}, {"componentType", kFloat}, {"count", vertices}, {"type", "VEC3"}},
            {{"bufferView", 2}, {"componentType", kUint32}, {"count", 3 * triangles}, {"type", "SCALAR"}}}},
          {"bufferViews",
           {{{"buffer", 0}, {"byteOffset", 0}, {"byteLength", vertex_bytes}, {"target", kArrayBuffer}},
            {{"buffer", 0}, {"byteOffset", vertex_bytes}, {"byteLength", vertex_bytes}, {"target", kArrayBuffer}},
            {{"buffer", 0},
             {"byteOffset", 2 * vertex_bytes},
             {"byteLength", index_bytes},
             {"target", kElementArrayBuffer}}}},
          {"buffers", Json::array({std::move(buffer)})}};
}

void AppendUint32(uint64_t value, std::string* bytes) {
  const uint32_t v = static_cast<uint32_t>(value);
  bytes->append(reinterpret_cast<const char*>(&v), sizeof(v));
}

absl::Status WriteGlb(const ChunkSpool& spool, ByteSink& file) {
  const Json document = GltfDocument(spool, Json::object());
  const uint64_t buffer_bytes = document["buffers"][0]["byteLength"];
  std::string text = document.dump();
  text.append((4 - text.size() % 4) % 4, ' ');
  const uint64_t total = 12 + 8 + text.size() + 8 + buffer_bytes;
  if (total > 0xffffffffu) {
    return absl::InternalError(
        absl::StrCat(file.name(), " can't be written: a GLB of ", total, " bytes; at most 4294967295 fit"));
  }
  std::string header = "glTF";
  AppendUint32(2, &header), AppendUint32(total, &header);
  AppendUint32(text.size(), &header);
  header += "JSON" + text;
  AppendUint32(buffer_bytes, &header);
  header.append("BIN\0", 4);
  MESHFRONT_RETURN_IF_ERROR(file.Append(header));
  return ForEachBufferPart(spool, [&](absl::string_view bytes) { return file.Append(bytes); });
}

// Base64 of a byte sequence that arrives in pieces.
class Base64Writer {
 public:
  explicit Base64Writer(ByteSink& file) : file_(file) {}

  absl::Status Append(absl::string_view bytes) {
    std::string text;
    for (const char byte : bytes) {
      pending_ = pending_ << 8 | static_cast<uint8_t>(byte);
      if (++pending_bytes_ == 3) AppendGroup(&text);
    }
    return file_.Append(text);
  }

  absl::Status Finish() {
    if (pending_bytes_ == 0) return absl::OkStatus();
    const int missing = 3 - pending_bytes_;
    pending_ <<= 8 * missing;
    std::string text;
    AppendGroup(&text);
    text.replace(text.size() - missing, missing, missing, '=');
    return file_.Append(text);
  }

 private:
  void AppendGroup(std::string* text) {
    static constexpr char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    for (int shift = 18; shift >= 0; shift -= 6) text->push_back(digits[pending_ >> shift & 63]);
    pending_ = 0, pending_bytes_ = 0;
  }

  ByteSink& file_;
  uint32_t pending_ = 0;
  int pending_bytes_ = 0;
};

absl::Status WriteGltf(const ChunkSpool& spool, ByteSink& file) {
  // The buffer's text goes where this mark stands, too long to be held.
  static constexpr absl::string_view mark = "@buffer@";
  const std::string text = GltfDocument(spool, {{"uri", std::string(mark)}}).dump();
  const size_t at = text.find(mark.data(), 0, mark.size());
  MESHFRONT_RETURN_IF_ERROR(file.Append(text.substr(0, at)));
  MESHFRONT_RETURN_IF_ERROR(file.Append("data:application/octet-stream;base64,"));
  Base64Writer base64(file);
  MESHFRONT_RETURN_IF_ERROR(ForEachBufferPart(spool, [&](absl::string_view bytes) { return base64.Append(bytes); }));
  MESHFRONT_RETURN_IF_ERROR(base64.Finish());
  return file.Append(text.substr(at + mark.size()));
}

}  // namespace

bool HoldsNormals(Format format) { return format == Format::kGlb || format == Format::kGltf; }

absl::Status CheckWritable(Format format) {
  if (format != Format::kXyz) return absl::OkStatus();
  return absl::InvalidArgumentError("XYZ holds points only; a mesh is written as OFF, OBJ, PLY, STL, GLB or glTF");
}

absl::Status WriteSpool(const ChunkSpool& spool, Format format, ByteSink& file) {
  MESHFRONT_RETURN_IF_ERROR(CheckWritable(format));
  switch (format) {
    case Format::kOff:
      return WriteOff(spool, file);
    case Format::kObj:
      return WriteObj(spool, file);
    case Format::kPly:
      return WritePly(spool, file);
    case Format::kStl:
      return WriteStl(spool, file);
    case Format::kGlb:
      return WriteGlb(spool, file);
    case Format::kGltf:
      return WriteGltf(spool, file);
    default:
      return absl::InternalError("unknown format");
  }
}

}  // namespace meshfront
