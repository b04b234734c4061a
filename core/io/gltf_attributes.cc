#include "core/io/gltf_attributes.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string_view>
#include <utility>

#include "core/io/source.h"

namespace meshfront {
namespace {

constexpr uint64_t kMostExpansion = 16, kFreeBytes = 32 << 20;  // of attributes and of what is kept, over the file
constexpr size_t kMostPlainChannels = 64, kMostMorphChannels = kMaxAttributeChannels - kMostPlainChannels;
constexpr uint32_t kMostTargets = 4096;  // of a primitive
constexpr size_t kMostNameBytes = 64;

// Numbers that a value of an attribute must have; 0: any.
int WantedComponents(std::string_view name) {
  if (const std::optional<MorphName> morph = MorphNameOf(name)) {
    const std::string_view of = morph->attribute;
    if (of == "POSITION" || of == "NORMAL" || of == "TANGENT") return 3;
    return RoleOfName(of) == AttributeRole::kTexcoord ? 2 : 0;
  }
  switch (RoleOfName(name)) {
    case AttributeRole::kNormal:
      return 3;
    case AttributeRole::kTangent:
    case AttributeRole::kJoints:
    case AttributeRole::kWeights:
      return 4;
    case AttributeRole::kTexcoord:
      return 2;
    default:
      return 0;
  }
}

Vec3 CarriedNormal(const GltfTransform& t, const Vec3& n) {
  const double sign = Dot(Cross(t.x, t.y), t.z) < 0 ? -1 : 1;
  return Normalized(sign * (n.x * Cross(t.y, t.z) + n.y * Cross(t.z, t.x) + n.z * Cross(t.x, t.y)));
}

void ToWorld(const GltfTransform& t, AttributeRole role, float* at) {
  if (role != AttributeRole::kNormal && role != AttributeRole::kTangent) return;
  const Vec3 v{at[0], at[1], at[2]};
  if (KeepsBits(t, v)) return;
  const Vec3 moved =
      role == AttributeRole::kNormal ? CarriedNormal(t, v) : Normalized(v.x * t.x + v.y * t.y + v.z * t.z);
  for (int axis = 0; axis < 3; ++axis) at[axis] = static_cast<float>(moved[axis]);
  if (role == AttributeRole::kTangent && Dot(Cross(t.x, t.y), t.z) < 0) at[3] = -at[3];
}

bool IsRegular(const GltfTransform& t) {
  const double volume = Dot(Cross(t.x, t.y), t.z);
  return std::isfinite(1 / volume) && IsFinite(t.origin);
}

}  // namespace

// Attributes but POSITION, then those of morph targets.
template <class Visit>
void GltfAttributeReader::VisitNames(JsonValue primitive, const Visit& visit) {
  const JsonValue attributes = primitive.Find("attributes"), targets = primitive.Find("targets");
  for (JsonValue v = attributes.First(); v.exists(); v = v.Next()) {
    const std::string name = v.Key();
    const bool is_named = !name.empty() && name.size() <= kMostNameBytes && !MorphNameOf(name);
    if (is_named && name != "POSITION") visit(name, v);
  }
  uint32_t target = 0;
  for (JsonValue t = targets.First(); t.exists() && target < kMostTargets; t = t.Next(), ++target) {
    for (JsonValue v = t.First(); t.is_object() && v.exists(); v = v.Next()) {
      const std::string name = v.Key();
      if (!name.empty() && name.size() <= kMostNameBytes) visit(NameOfMorph(target, name), v);
    }
  }
}

const GltfAccessor* GltfAttributeReader::Usable(const std::string& name, JsonValue index, uint64_t vertices) {
  const absl::StatusOr<const GltfAccessor*> accessor = file_.Accessor(index, name);
  if (!accessor.ok() || (*accessor)->count != vertices) return nullptr;
  const int wanted = WantedComponents(name);
  return wanted == 0 || (*accessor)->components == wanted ? *accessor : nullptr;
}

// An accessor without any bytes: all of its elements are zero, which for a morph target is to do nothing.
bool GltfAttributeReader::IsZero(JsonValue index) {
  const uint64_t count = file_.Count("accessors"), number = index.Integer().value_or(count);
  const JsonValue accessor = file_.Element("accessors", number);
  return number < count && !accessor.Find("bufferView").exists() && !accessor.Find("sparse").exists();
}

bool GltfAttributeReader::ChannelList::Add(const std::string& name, uint32_t components, size_t most) {
  const auto [at, is_new] = index.try_emplace(name, channels.size());
  if (is_new && channels.size() == most) {
    index.erase(at);
    return false;
  }
  if (is_new) channels.push_back({name, 0});
  uint32_t& known = channels[at->second].components;
  stride += std::max(known, components) - known;
  known = std::max(known, components);
  return true;
}

bool GltfAttributeReader::Fits(uint64_t stride) const {
  return wedges_ <= (kMostExpansion * file_.total_bytes() + kFreeBytes) / (4 * std::max<uint64_t>(stride, 1));
}

void GltfAttributeReader::Count(JsonValue primitive, uint64_t vertices) {
  wedges_ += vertices;
  if (counted_.insert(primitive.node()).second) {
    VisitNames(primitive, [&](const std::string& name, JsonValue index) {
      const GltfAccessor* const accessor = Usable(name, index, vertices);
      const bool is_morph = MorphNameOf(name).has_value();
      if (accessor == nullptr) {
        lost_morphs_ = lost_morphs_ || (is_morph && !IsZero(index));
        return;
      }
      const auto components = static_cast<uint32_t>(accessor->components);
      if (!is_morph) plain_.Add(name, components, kMostPlainChannels);
      if (is_morph) morphs_fit_ = morphs_.Add(name, components, kMostMorphChannels) && morphs_fit_;
    });
    morphs_fit_ = morphs_fit_ && primitive.Find("targets").size() <= kMostTargets;
  }
  fits_ = Fits(plain_.stride);
  morphs_fit_ = morphs_fit_ && Fits(plain_.stride + morphs_.stride);
}

// The accessors of all channels that the primitive has; what they are called goes to the group.
GltfAttributeReader::Accessors GltfAttributeReader::Open(JsonValue primitive, uint64_t vertices, GltfGroup& group) {
  Accessors accessors;
  VisitNames(primitive, [&](const std::string& name, JsonValue index) {
    if (!plain_.index.contains(name) && !(morphs_fit_ && morphs_.index.contains(name))) return;
    if (const GltfAccessor* const accessor = Usable(name, index, vertices)) accessors[name] = accessor;
  });
  for (const AttributeChannel& c : channels_) {
    if (accessors.contains(c.name)) group.attributes.push_back(c.name);
  }
  group.targets = morphs_fit_ ? primitive.Find("targets").size() : 0;
  return accessors;
}

void GltfAttributeReader::Add(GltfGroup group, JsonValue primitive, const Range& range, TriangleMesh& mesh) {
  MeshAttributes& a = mesh.attributes;
  if (asset_->groups.empty()) {
    channels_ = plain_.channels;
    if (morphs_fit_) channels_.insert(channels_.end(), morphs_.channels.begin(), morphs_.channels.end());
  }
  fits_ = fits_ && IsRegular(group.to_world);
  a.groups.resize(mesh.triangles.size(), static_cast<uint32_t>(asset_->groups.size()));
  if (fits_) {
    const Accessors accessors = Open(primitive, range.vertices, group);
    if (!channels_.empty()) AddCorners(group, primitive, accessors, range, mesh);
  }
  asset_->groups.push_back(std::move(group));
  names_.push_back(MaterialOf(primitive));
}

// Primitives of a node that name the same accessors share their wedges.
void GltfAttributeReader::AddCorners(const GltfGroup& group, JsonValue primitive, const Accessors& accessors,
                                     const Range& range, TriangleMesh& mesh) {
  MeshAttributes& a = mesh.attributes;
  const std::string key = Concat(group.node, " ", group.mesh, " ", primitive.Find("attributes").Raw(), " ",
                                 primitive.Find("targets").Raw());
  const auto [first, is_new] = first_wedge_.try_emplace(key, a.wedge_count());
  if (is_new) {
    a.channels = channels_;
    AddWedges(group, accessors, range.vertices, a);
  }
  for (size_t f = range.first_triangle; f < mesh.triangles.size(); ++f) {
    CornerWedges corners;
    for (int i = 0; i < 3; ++i)
      corners[i] = static_cast<uint32_t>(first->second + mesh.triangles[f][i].index() - range.first_vertex);
    a.corners.push_back(corners);
  }
}

// "" where there is none.
std::string GltfAttributeReader::MaterialOf(JsonValue primitive) {
  const uint64_t count = file_.Count("materials"), index = primitive.Find("material").Integer().value_or(count);
  if (index >= count) return "";
  const std::string name = file_.Element("materials", index).Find("name").String();
  return name.empty() ? Concat("material_", index) : name;
}

void GltfAttributeReader::AddWedges(const GltfGroup& group, const Accessors& accessors, uint64_t vertices,
                                    MeshAttributes& to) {
  const size_t stride = to.Stride(), begin = to.values.size();
  to.values.resize(begin + stride * vertices);
  size_t offset = 0;
  for (const AttributeChannel& channel : channels_) {
    const auto found = accessors.find(channel.name);
    const GltfAccessor* const accessor = found == accessors.end() ? nullptr : found->second;
    const AttributeRole role = RoleOfName(channel.name);
    for (uint64_t i = 0; i < vertices; ++i) {
      float* const at = to.values.data() + begin + i * stride + offset;
      if (role == AttributeRole::kColour) std::fill(at, at + channel.components, 1.0f);
      for (int c = 0; accessor != nullptr && c < accessor->components; ++c) {
        const auto value = static_cast<float>(accessor->NumberAt(i, c));
        at[c] = std::isfinite(value) ? value : 0;
        not_finite_ += !std::isfinite(value);
      }
      ToWorld(group.to_world, role, at);
    }
    offset += channel.components;
  }
}

bool GltfAttributeReader::KeepView(JsonValue index) {
  if (!index.Integer() || asset_->views.count(*index.Integer()) > 0) return index.Integer().has_value();
  const absl::StatusOr<absl::Span<const uint8_t>> bytes = file_.View(*index.Integer());
  if (!bytes.ok()) return false;
  kept_bytes_ += bytes->size();
  if (kept_bytes_ > 2 * file_.total_bytes()) return false;
  asset_->views[*index.Integer()] = std::string(reinterpret_cast<const char*>(bytes->data()), bytes->size());
  return true;
}

void GltfAttributeReader::KeepAccessor(JsonValue index) {
  if (!index.Integer() || *index.Integer() >= file_.Count("accessors")) return;
  const JsonValue accessor = file_.Element("accessors", *index.Integer()), sparse = accessor.Find("sparse");
  for (const JsonValue view : {accessor.Find("bufferView"), sparse.Find("indices").Find("bufferView"),
                               sparse.Find("values").Find("bufferView")}) {
    if (view.exists()) fits_ = KeepView(view) && fits_;
  }
}

void GltfAttributeReader::KeepViews() {
  for (uint64_t i = 0; i < file_.Count("images"); ++i) {
    const JsonValue view = file_.Element("images", i).Find("bufferView");
    if (view.exists()) fits_ = KeepView(view) && fits_;
  }
  for (uint64_t i = 0; i < file_.Count("skins"); ++i)
    KeepAccessor(file_.Element("skins", i).Find("inverseBindMatrices"));
  for (uint64_t i = 0; i < file_.Count("animations"); ++i) {
    const JsonValue samplers = file_.Element("animations", i).Find("samplers");
    for (JsonValue s = samplers.First(); s.exists(); s = s.Next())
      KeepAccessor(s.Find("input")), KeepAccessor(s.Find("output"));
  }
}

void GltfAttributeReader::Finish(ReadResult& result) {
  for (const GltfGroup& group : asset_->groups) {
    const bool again = group.node >= 0 && group.primitive == 0 && !nodes_.insert(group.node).second;
    fits_ = fits_ && !again;
  }
  KeepViews();
  MeshAttributes& a = result.mesh.attributes;
  if (not_finite_ > 0) result.warnings.push_back(NotFiniteAttributes(not_finite_));
  if (!fits_ || file_.document().exhausted()) {
    a = {};
    NoteDropped(result.mesh, "materials, nodes and animations");
    return;
  }
  if (asset_->groups.size() == 1) a.groups = {};
  result.asset.group_names = std::move(names_);
  asset_->json = std::string(file_.root().Raw());
  result.asset.gltf = std::move(asset_);
}

}  // namespace meshfront
