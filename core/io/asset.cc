// Meshes with attributes, to OBJ, PLY, GLB and glTF.
#include <algorithm>
#include <charconv>
#include <cmath>
#include <numeric>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/escaping.h"
#include "core/base/status_macros.h"
#include "core/io/gltf_asset.h"
#include "core/io/mesh_io.h"
#include "core/io/output.h"
#include "core/io/source.h"

namespace meshfront {
namespace {

constexpr uint64_t kMostGlbBytes = 0xffffffffu;

void Note(std::vector<std::string>& list, const std::string& what) {
  if (std::find(list.begin(), list.end(), what) == list.end()) list.push_back(what);
}

void NoteChannel(std::vector<std::string>& list, const AttributeChannel& channel) {
  Note(list, NamesForMessage({channel}).front());
}

void NoteAsset(const MeshAsset& asset, std::vector<std::string>& left_out) {
  if (asset.gltf != nullptr) Note(left_out, "nodes, textures, animations and skins of the glTF");
}

std::string GroupName(const MeshAsset& asset, uint32_t group) {
  if (group < asset.group_names.size() && !asset.group_names[group].empty()) return asset.group_names[group];
  return Concat("group_", group);
}

// --- OBJ

class ObjWriter {
 public:
  ObjWriter(const TriangleMesh& mesh, const MeshAsset& asset, Output& output)
      : mesh_(mesh), a_(mesh.attributes), asset_(asset), output_(output) {}

  void Write(std::vector<std::string>& left_out) {
    texcoord_ = a_.OffsetOf("TEXCOORD_0"), normal_ = a_.OffsetOf("NORMAL");
    for (const AttributeChannel& c : a_.channels) {
      const bool is_kept = (c.name == "TEXCOORD_0" && c.components >= 2) || c.name == "NORMAL";
      if (!is_kept) NoteChannel(left_out, c);
      if (!is_kept && c.name == "TEXCOORD_0") texcoord_.reset();
    }
    for (const std::string& library : asset_.material_libraries) Line("mtllib ", library);
    for (const Vec3& p : mesh_.positions) output_.Text("v "), output_.Triple(p), output_.Text("\n");
    for (uint32_t w = 0; w < a_.wedge_count(); ++w) WriteWedge(a_.WedgeAt(w));
    const std::vector<uint32_t> faces = FacesByGroup();
    for (size_t i = 0; i < faces.size(); ++i) {
      const bool begins = !a_.groups.empty() && (i == 0 || a_.groups[faces[i]] != a_.groups[faces[i - 1]]);
      if (begins) Line("usemtl ", GroupName(asset_, a_.groups[faces[i]]));
      WriteFace(faces[i]);
    }
  }

 private:
  void Line(std::string_view word, const std::string& rest) {
    output_.Text(word), output_.Text(rest), output_.Text("\n");
  }

  // Each group once: the front goes from one to another and back, and every change would be another draw call.
  std::vector<uint32_t> FacesByGroup() const {
    std::vector<uint32_t> faces(mesh_.triangles.size());
    std::iota(faces.begin(), faces.end(), 0u);
    std::stable_sort(faces.begin(), faces.end(), [&](uint32_t f, uint32_t g) { return a_.GroupOf(f) < a_.GroupOf(g); });
    return faces;
  }

  void WriteWedge(absl::Span<const float> values) {
    if (texcoord_) Numbers("vt", values.subspan(*texcoord_, 2));
    if (normal_) Numbers("vn", values.subspan(*normal_, 3));
  }
  // A float in as few digits as bring it back.
  void Numbers(std::string_view word, absl::Span<const float> values) {
    output_.Text(word);
    for (const float v : values) {
      char digits[32];
      const std::to_chars_result end = std::to_chars(digits, digits + sizeof(digits), v);
      output_.Text(" "), output_.Text({digits, static_cast<size_t>(end.ptr - digits)});
    }
    output_.Text("\n");
  }

  void WriteFace(size_t f) {
    output_.Text("f");
    for (int i = 0; i < 3; ++i) {
      output_.Text(" "), output_.Number(uint64_t{mesh_.triangles[f][i].index()} + 1);
      if (!texcoord_ && !normal_) continue;
      const uint64_t wedge = uint64_t{a_.corners[f][i]} + 1;
      output_.Text("/");
      if (texcoord_) output_.Number(wedge);
      if (normal_) output_.Text("/"), output_.Number(wedge);
    }
    output_.Text("\n");
  }

  const TriangleMesh& mesh_;
  const MeshAttributes& a_;
  const MeshAsset& asset_;
  Output& output_;
  std::optional<uint32_t> texcoord_, normal_;
};

// --- PLY

// What a channel's components are called, and whether they are 8 bits; none: it has no place.
std::vector<std::string> PlyNames(const AttributeChannel& channel) {
  if (MorphNameOf(channel.name)) return {};
  if (channel.name == "NORMAL") return {"nx", "ny", "nz"};
  if (channel.name == "TEXCOORD_0" && channel.components == 2) return {"s", "t"};
  if (channel.name == "COLOR_0" && channel.components == 3) return {"red", "green", "blue"};
  if (channel.name == "COLOR_0" && channel.components == 4) return {"red", "green", "blue", "alpha"};
  const bool is_word =
      std::none_of(channel.name.begin(), channel.name.end(), [](unsigned char c) { return c <= ' ' || c == 127; });
  if (!is_word) return {};
  if (channel.components == 1) return {channel.name};
  std::vector<std::string> names;
  for (uint32_t i = 0; i < channel.components; ++i) names.push_back(Concat(channel.name, "_", i));
  return names;
}

class PlyWriter {
 public:
  PlyWriter(const TriangleMesh& mesh, Output& output) : mesh_(mesh), a_(mesh.attributes), output_(output) {}

  // A vertex has one value of each channel: those that have several anywhere have no place, and the mesh stays closed.
  void Write(std::vector<std::string>& left_out) {
    ChooseWedges();
    output_.Text("ply\nformat binary_little_endian 1.0\ncomment Meshfront\nelement vertex ");
    output_.Number(uint64_t{mesh_.positions.size()});
    output_.Text("\nproperty double x\nproperty double y\nproperty double z\n");
    uint32_t offset = 0;
    for (const AttributeChannel& c : a_.channels) {
      const std::vector<std::string> names = HasSeams(offset, c.components) ? std::vector<std::string>() : PlyNames(c);
      const bool is_byte = c.name == "COLOR_0";
      if (names.empty()) NoteChannel(left_out, c);
      for (size_t i = 0; i < names.size(); ++i) {
        output_.Text(Concat("property ", is_byte ? "uchar " : "float ", names[i], "\n"));
        properties_.push_back({offset + static_cast<uint32_t>(i), is_byte});
      }
      offset += c.components;
    }
    output_.Text("element face "), output_.Number(uint64_t{mesh_.triangles.size()});
    output_.Text("\nproperty list uchar uint vertex_indices\nend_header\n");
    for (uint32_t v = 0; v < mesh_.positions.size(); ++v) WriteVertex(v);
    for (const Triangle& t : mesh_.triangles) output_.Raw(uint8_t{3}), output_.Raw(t);
    if (!a_.groups.empty()) Note(left_out, "materials");
  }

 private:
  void ChooseWedges() {
    wedges_.assign(mesh_.positions.size(), kNone);
    others_.clear();
    for (size_t f = 0; f < a_.corners.size(); ++f) {
      for (int i = 0; i < 3; ++i) {
        uint32_t& wedge = wedges_[mesh_.triangles[f][i].index()];
        if (wedge == kNone) wedge = a_.corners[f][i];
        if (wedge != a_.corners[f][i]) others_.push_back({wedge, a_.corners[f][i]});
      }
    }
  }
  bool HasSeams(uint32_t offset, uint32_t components) const {
    return std::any_of(others_.begin(), others_.end(), [&](const auto& pair) {
      return a_.WedgeAt(pair.first).subspan(offset, components) != a_.WedgeAt(pair.second).subspan(offset, components);
    });
  }

  void WriteVertex(uint32_t vertex) {
    output_.Raw(mesh_.positions[vertex]);
    const uint32_t wedge = wedges_[vertex];
    for (const auto& [offset, is_byte] : properties_) {
      const float value = wedge == kNone ? 0 : a_.WedgeAt(wedge)[offset];
      if (is_byte)
        output_.Raw(static_cast<uint8_t>(std::lround(255 * std::clamp(value, 0.0f, 1.0f))));
      else
        output_.Raw(value);
    }
  }

  const TriangleMesh& mesh_;
  const MeshAttributes& a_;
  Output& output_;
  static constexpr uint32_t kNone = 0xffffffffu;
  std::vector<uint32_t> wedges_;                       // of each vertex, its first one
  std::vector<std::pair<uint32_t, uint32_t>> others_;  // … and another that it has at a seam
  std::vector<std::pair<uint32_t, bool>> properties_;
};

// --- glTF

absl::StatusOr<std::string> GlbOf(const GltfDocument& document) {
  std::string json = document.json_before_uri + document.json_after_uri, buffer = document.buffer;
  json.resize((json.size() + 3) / 4 * 4, ' ');
  buffer.resize((buffer.size() + 3) / 4 * 4, '\0');
  const uint64_t length = 12 + 8 + json.size() + 8 + buffer.size();
  if (length > kMostGlbBytes)
    return absl::InvalidArgumentError(Concat("GLB holds 4 GiB at most; the mesh takes ", length, " bytes"));
  std::string out = "glTF";
  const auto put = [&](uint64_t value) {
    const auto v = static_cast<uint32_t>(value);
    out.append(reinterpret_cast<const char*>(&v), sizeof(v));
  };
  put(2), put(length), put(json.size());
  out += "JSON" + json;
  put(buffer.size());
  out.append("BIN\0", 4);
  return out + buffer;
}

std::string GltfOf(const GltfDocument& document) {
  return Concat(document.json_before_uri, "\"uri\":\"data:application/octet-stream;base64,",
                absl::Base64Escape(document.buffer), "\",", document.json_after_uri, "\n");
}

absl::StatusOr<std::string> FormatInGltf(absl::Span<const DetailLevel> levels, Format format, const MeshAsset& asset,
                                         std::vector<std::string>& left_out) {
  const GltfAsset plain = asset.gltf == nullptr ? PlainGltfAsset(*levels.front().mesh, asset.group_names) : GltfAsset();
  if (!asset.material_libraries.empty()) Note(left_out, "textures and colours of the material libraries");
  MESHFRONT_ASSIGN_OR_RETURN(const GltfDocument document,
                             FormatGltf(levels, asset.gltf == nullptr ? plain : *asset.gltf, left_out));
  return format == Format::kGlb ? GlbOf(document) : GltfOf(document);
}

}  // namespace

bool HoldsAttributes(Format format) {
  return format == Format::kObj || format == Format::kPly || format == Format::kGlb || format == Format::kGltf;
}

std::vector<std::string> FilesBeside(const MeshAsset& asset) {
  std::vector<std::string> files = asset.material_libraries;
  if (asset.gltf == nullptr) return files;
  const std::vector<std::string> images = ImageFilesOf(*asset.gltf);
  files.insert(files.end(), images.begin(), images.end());
  return files;
}

absl::StatusOr<std::string> FormatAsset(const TriangleMesh& mesh, Format format, const MeshAsset& asset,
                                        std::vector<std::string>& left_out) {
  MESHFRONT_RETURN_IF_ERROR(ValidateAttributes(mesh.attributes, mesh.triangles.size()));
  const DetailLevel level{&mesh};
  if (format == Format::kGlb || format == Format::kGltf) return FormatInGltf({&level, 1}, format, asset, left_out);
  NoteAsset(asset, left_out);
  StringSink sink;
  Output output(sink);
  if (format == Format::kObj)
    ObjWriter(mesh, asset, output).Write(left_out);
  else if (format == Format::kPly)
    PlyWriter(mesh, output).Write(left_out);
  else
    return FormatMesh(mesh, format);
  MESHFRONT_RETURN_IF_ERROR(output.Finish());
  return sink.Take();
}

absl::StatusOr<std::string> FormatLevels(absl::Span<const DetailLevel> levels, Format format, const MeshAsset& asset,
                                         std::vector<std::string>& left_out) {
  if (levels.empty() || (format != Format::kGlb && format != Format::kGltf))
    return absl::InvalidArgumentError("levels of detail in one file are for GLB and glTF, and at least one");
  for (const DetailLevel& level : levels)
    MESHFRONT_RETURN_IF_ERROR(ValidateAttributes(level.mesh->attributes, level.mesh->triangles.size()));
  return FormatInGltf(levels, format, asset, left_out);
}

}  // namespace meshfront
