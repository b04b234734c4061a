#include "core/io/obj_attributes.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

namespace meshfront {
namespace {

constexpr size_t kMostMaterials = 65536;

// An integer at the beginning of the text, which it takes off; 0 where there is none.
int64_t TakeInteger(std::string_view& text) {
  int64_t value = 0;
  const std::from_chars_result end = std::from_chars(text.data(), text.data() + text.size(), value);
  text.remove_prefix(end.ptr - text.data());
  return end.ec == std::errc() ? value : 0;
}

bool IsFiniteArray(absl::Span<const float> values) {
  return std::all_of(values.begin(), values.end(), [](float v) { return std::isfinite(v); });
}

}  // namespace

void ObjAttributes::UseMaterial(const std::string& name) {
  const auto [at, is_new] = known_materials_.try_emplace(name, static_cast<uint32_t>(materials_.size()));
  if (is_new && materials_.size() < kMostMaterials) materials_.push_back(name);
  material_ = std::min<uint32_t>(at->second, kMostMaterials - 1);
}

uint32_t ObjAttributes::Resolve(int64_t value, size_t count) {
  if (value > 0) return static_cast<uint32_t>(std::min<int64_t>(value - 1, kNone));
  return value < 0 && -value <= static_cast<int64_t>(count) ? static_cast<uint32_t>(count + value) : kNone;
}

uint32_t ObjAttributes::WedgeOf(std::string_view rest) {
  Names names{kNone, kNone};
  if (!rest.empty()) rest.remove_prefix(1);
  names.first = Resolve(TakeInteger(rest), texcoords_.size());
  if (!rest.empty()) rest.remove_prefix(1);
  names.second = Resolve(TakeInteger(rest), normals_.size());
  has_texcoords_ |= names.first != kNone;
  has_normals_ |= names.second != kNone;
  const auto [at, is_new] = known_.try_emplace(names, static_cast<uint32_t>(wedges_.size()));
  if (is_new) wedges_.push_back(names);
  return at->second;
}

void ObjAttributes::AddFace(absl::Span<const uint32_t> vertices, absl::Span<const uint32_t> wedges,
                            const TriangleMesh& mesh) {
  absl::flat_hash_map<uint32_t, uint32_t> wedge_of;
  if (vertices.size() > 3) {
    for (size_t i = 0; i < vertices.size(); ++i) wedge_of.try_emplace(vertices[i], wedges[i]);
  }
  for (size_t f = corners_.size(); f < mesh.triangles.size(); ++f) {
    CornerWedges corners;
    for (int i = 0; i < 3; ++i)
      corners[i] = vertices.size() == 3 ? wedges[i] : wedge_of.at(mesh.triangles[f][i].index());
    corners_.push_back(corners);
    groups_.push_back(material_);
  }
}

// Faces before the first usemtl have a group of their own.
MeshAttributes ObjAttributes::Take(size_t triangles) {
  MeshAttributes a;
  corners_.resize(triangles);
  if (!materials_.empty()) {
    if (std::find(groups_.begin(), groups_.end(), kNone) != groups_.end()) {
      std::replace(groups_.begin(), groups_.end(), kNone, static_cast<uint32_t>(materials_.size()));
      materials_.push_back("");
    }
    a.groups = std::move(groups_);
  }
  if (has_texcoords_) a.channels.push_back({"TEXCOORD_0", 2});
  if (has_normals_) a.channels.push_back({"NORMAL", 3});
  if (a.channels.empty()) return a;
  for (const auto& [texcoord, normal] : wedges_) {
    const bool has_texcoord = texcoord < texcoords_.size() && IsFiniteArray(texcoords_[texcoord]);
    const bool has_normal = normal < normals_.size() && IsFiniteArray(normals_[normal]);
    missing_ += (has_texcoords_ && !has_texcoord) || (has_normals_ && !has_normal);
    const std::array<float, 2> t = has_texcoord ? texcoords_[texcoord] : std::array<float, 2>{0, 0};
    const std::array<float, 3> n = has_normal ? normals_[normal] : std::array<float, 3>{0, 0, 0};
    if (has_texcoords_) a.values.insert(a.values.end(), t.begin(), t.end());
    if (has_normals_) a.values.insert(a.values.end(), n.begin(), n.end());
  }
  a.corners = std::move(corners_);
  return a;
}

std::vector<std::string> ObjAttributes::TakeMaterials() { return std::move(materials_); }

}  // namespace meshfront
