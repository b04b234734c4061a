#include "core/mesh/attributes.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <utility>

#include "absl/container/flat_hash_set.h"
#include "absl/strings/str_cat.h"
#include "core/base/status_macros.h"

namespace meshfront {
namespace {

constexpr size_t kMaxNameBytes = 128;
constexpr std::string_view kMorphStem = "MORPH_";

bool IsNumbered(std::string_view name, std::string_view stem) {
  return name.size() > stem.size() && name.substr(0, stem.size()) == stem &&
         name.find_first_not_of("0123456789", stem.size()) == std::string_view::npos;
}

Vec3 VectorAt(const float* values) { return {values[0], values[1], values[2]}; }
void SetVector(const Vec3& v, float* out) {
  out[0] = static_cast<float>(v.x), out[1] = static_cast<float>(v.y), out[2] = static_cast<float>(v.z);
}

uint32_t LeastComponents(std::string_view name) {
  if (const std::optional<MorphName> morph = MorphNameOf(name)) {
    const std::string_view of = morph->attribute;
    return of == "POSITION" || of == "NORMAL" || of == "TANGENT" ? 3 : 1;
  }
  const AttributeRole role = RoleOfName(name);
  return role == AttributeRole::kNormal ? 3 : role == AttributeRole::kTangent ? 4 : 1;
}

absl::Status CheckChannel(const AttributeChannel& c) {
  if (c.name.empty() || c.name.size() > kMaxNameBytes) {
    return absl::InvalidArgumentError(
        absl::StrCat("an attribute's name has ", c.name.size(), " bytes; it must have 1 to ", kMaxNameBytes));
  }
  const uint32_t least = LeastComponents(c.name);
  if (c.components < least || c.components > kMaxAttributeComponents) {
    return absl::InvalidArgumentError(absl::StrCat("attribute ", c.name, " has ", c.components,
                                                   " components; it must have ", least, " to ",
                                                   kMaxAttributeComponents));
  }
  return absl::OkStatus();
}

}  // namespace

absl::Status ValidateChannels(const std::vector<AttributeChannel>& channels) {
  if (channels.size() > kMaxAttributeChannels) {
    return absl::InvalidArgumentError(
        absl::StrCat("there are ", channels.size(), " attributes; at most ", kMaxAttributeChannels, " can be carried"));
  }
  absl::flat_hash_set<std::string_view> names;
  for (const AttributeChannel& c : channels) {
    MESHFRONT_RETURN_IF_ERROR(CheckChannel(c));
    if (!names.insert(c.name).second)
      return absl::InvalidArgumentError(absl::StrCat("attribute ", c.name, " is there twice"));
  }
  return absl::OkStatus();
}

std::optional<MorphName> MorphNameOf(std::string_view name) {
  if (name.substr(0, kMorphStem.size()) != kMorphStem) return std::nullopt;
  const std::string_view rest = name.substr(kMorphStem.size());
  const size_t end = std::min(rest.find('_'), rest.size());
  MorphName morph;
  const auto [last, error] = std::from_chars(rest.data(), rest.data() + end, morph.target);
  if (error != std::errc() || last != rest.data() + end || end + 1 >= rest.size()) return std::nullopt;
  morph.attribute = rest.substr(end + 1);
  return morph;
}

std::string NameOfMorph(uint32_t target, std::string_view attribute) {
  return std::string(kMorphStem) + std::to_string(target) + "_" + std::string(attribute);
}

std::vector<std::string> NamesForMessage(const std::vector<AttributeChannel>& channels) {
  std::vector<std::string> names;
  bool has_morphs = false;
  for (const AttributeChannel& c : channels) {
    const bool is_morph = RoleOfName(c.name) == AttributeRole::kMorph;
    if (!is_morph || !has_morphs) names.push_back(is_morph ? "morph targets" : c.name);
    has_morphs = has_morphs || is_morph;
  }
  return names;
}

AttributeRole RoleOfName(std::string_view name) {
  if (name == "NORMAL") return AttributeRole::kNormal;
  if (name == "TANGENT") return AttributeRole::kTangent;
  if (IsNumbered(name, "TEXCOORD_")) return AttributeRole::kTexcoord;
  if (IsNumbered(name, "COLOR_")) return AttributeRole::kColour;
  if (IsNumbered(name, "JOINTS_")) return AttributeRole::kJoints;
  if (IsNumbered(name, "WEIGHTS_")) return AttributeRole::kWeights;
  return MorphNameOf(name) ? AttributeRole::kMorph : AttributeRole::kCustom;
}

uint32_t MeshAttributes::Stride() const {
  uint32_t stride = 0;
  for (const AttributeChannel& c : channels) stride += c.components;
  return stride;
}

std::optional<uint32_t> MeshAttributes::OffsetOf(std::string_view name) const {
  uint32_t offset = 0;
  for (const AttributeChannel& c : channels) {
    if (c.name == name) return offset;
    offset += c.components;
  }
  return std::nullopt;
}

absl::Status ValidateAttributes(const MeshAttributes& a, size_t triangles) {
  MESHFRONT_RETURN_IF_ERROR(ValidateChannels(a.channels));
  if (!a.groups.empty() && a.groups.size() != triangles)
    return absl::InvalidArgumentError(
        absl::StrCat("attributes.groups has ", a.groups.size(), " elements; there are ", triangles, " triangles"));
  if (a.corners.size() != (a.channels.empty() ? 0 : triangles))
    return absl::InvalidArgumentError(
        absl::StrCat("attributes.corners has ", a.corners.size(), " elements; there are ", triangles, " triangles"));
  if (a.channels.empty()) return absl::OkStatus();
  if (a.values.size() % a.Stride() != 0)
    return absl::InvalidArgumentError(
        absl::StrCat("attributes.values has ", a.values.size(), " numbers; it must be a multiple of ", a.Stride()));
  const uint32_t wedges = a.wedge_count();
  for (size_t f = 0; f < a.corners.size(); ++f) {
    for (const uint32_t w : a.corners[f]) {
      if (w >= wedges)
        return absl::InvalidArgumentError(
            absl::StrCat("attributes.corners: triangle ", f, " names wedge ", w, "; there are ", wedges));
    }
  }
  for (size_t i = 0; i < a.values.size(); ++i) {
    if (!std::isfinite(a.values[i]))
      return absl::InvalidArgumentError(absl::StrCat("attributes.values: wedge ", i / a.Stride(), " is not finite"));
  }
  return absl::OkStatus();
}

uint32_t AddWedgeBetween(MeshAttributes& attributes, uint32_t a, uint32_t b, double t) {
  const uint32_t stride = attributes.Stride(), made = attributes.wedge_count();
  attributes.values.reserve(attributes.values.size() + stride);
  const float nearer = t < 0.5 ? 0 : 1;
  for (const AttributeChannel& c : attributes.channels) {
    const AttributeRole role = RoleOfName(c.name);
    const bool is_skin = role == AttributeRole::kJoints || role == AttributeRole::kWeights;
    const float share = is_skin ? nearer : static_cast<float>(t);
    for (uint32_t i = 0; i < c.components; ++i) {
      const size_t at = attributes.values.size() - size_t{made} * stride;
      const float from = attributes.values[size_t{a} * stride + at], to = attributes.values[size_t{b} * stride + at];
      attributes.values.push_back((1 - share) * from + share * to);
    }
  }
  return made;
}

AttributeInterpolator::AttributeInterpolator(const MeshAttributes& attributes, bool smooth_normals)
    : attributes_(attributes), smooth_normals_(smooth_normals) {
  uint32_t offset = 0;
  for (const AttributeChannel& c : attributes.channels) {
    const AttributeRole role = RoleOfName(c.name);
    slots_.push_back({role, offset, c.components});
    if (role == AttributeRole::kNormal) normal_ = offset;
    offset += c.components;
  }
  for (size_t i = 0; i < slots_.size(); ++i) {
    if (slots_[i].role != AttributeRole::kJoints) continue;
    const auto weights = attributes.OffsetOf(absl::StrCat("WEIGHTS_", attributes.channels[i].name.substr(7)));
    if (weights) skins_.push_back({slots_[i].offset, *weights, slots_[i].components});
  }
}

void AttributeInterpolator::Append(const WedgeSource& source, std::vector<float>& out) const {
  const CornerWedges& corners = attributes_.corners[source.face];
  const double weights[3] = {1 - source.u - source.v, source.u, source.v};
  const absl::Span<const float> of[3] = {attributes_.WedgeAt(corners[0]), attributes_.WedgeAt(corners[1]),
                                         attributes_.WedgeAt(corners[2])};
  const size_t begin = out.size(), nearest = std::max_element(weights, weights + 3) - weights;
  out.resize(begin + of[0].size());
  float* const to = out.data() + begin;
  for (const Slot& s : slots_) {
    for (uint32_t i = s.offset; i < s.offset + s.components; ++i) {
      const bool is_last_of_tangent = s.role == AttributeRole::kTangent && i == s.offset + 3;
      if (s.role == AttributeRole::kJoints || is_last_of_tangent || (of[0][i] == of[1][i] && of[1][i] == of[2][i]))
        to[i] = of[nearest][i];
      else
        to[i] = static_cast<float>(weights[0] * of[0][i] + weights[1] * of[1][i] + weights[2] * of[2][i]);
    }
  }
  SetNormals(source, to);
  if (!skins_.empty()) SetSkin(corners, weights, to);
}

void AttributeInterpolator::SetNormals(const WedgeSource& source, float* out) const {
  Vec3 normal = source.normal;
  if (normal_) {
    const Vec3 mean = Normalized(VectorAt(out + *normal_));
    if (!smooth_normals_ && mean != Vec3{}) normal = mean;
    SetVector(normal, out + *normal_);
  }
  for (const Slot& s : slots_) {
    if (s.role != AttributeRole::kTangent) continue;
    const Vec3 tangent = VectorAt(out + s.offset);
    Vec3 flat = Normalized(tangent - Dot(tangent, normal) * normal);
    if (flat == Vec3{}) flat = Normalized(Cross(normal, std::abs(normal.x) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0}));
    SetVector(flat, out + s.offset);
  }
}

// The joints of the three corners with their weights there, and of them those that weigh most.
void AttributeInterpolator::SetSkin(const CornerWedges& corners, const double* weights, float* out) const {
  std::vector<std::pair<float, double>> joints;
  size_t room = 0;
  for (const Skin& skin : skins_) {
    room += skin.components;
    for (int corner = 0; corner < 3; ++corner) {
      const absl::Span<const float> values = attributes_.WedgeAt(corners[corner]);
      for (uint32_t i = 0; i < skin.components; ++i) {
        const double weight = weights[corner] * values[skin.weights + i];
        if (weight > 0) joints.emplace_back(values[skin.joints + i], weight);
      }
    }
  }
  std::sort(joints.begin(), joints.end());
  size_t kept = 0;
  for (size_t i = 0; i < joints.size(); ++i) {
    if (kept > 0 && joints[kept - 1].first == joints[i].first)
      joints[kept - 1].second += joints[i].second;
    else
      joints[kept++] = joints[i];
  }
  joints.resize(kept);
  std::stable_sort(joints.begin(), joints.end(), [](const auto& a, const auto& b) { return a.second > b.second; });
  joints.resize(room);
  double sum = 0;
  for (const auto& [joint, weight] : joints) sum += weight;
  size_t next = 0;
  for (const Skin& skin : skins_) {
    for (uint32_t i = 0; i < skin.components; ++i, ++next) {
      out[skin.joints + i] = joints[next].first;
      out[skin.weights + i] = static_cast<float>(sum > 0 ? joints[next].second / sum : 0);
    }
  }
}

}  // namespace meshfront
