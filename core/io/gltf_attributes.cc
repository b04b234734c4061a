#include "core/io/gltf_attributes.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/io/source.h"

namespace meshfront {
namespace {

constexpr uint64_t kMostExpansion = 16, kFreeBytes = 32 << 20;  // of attributes and of what is kept, over the file

// Numbers that a value of an attribute must have; 0: any.
int WantedComponents(AttributeRole role) {
  switch (role) {
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

const GltfAccessor* GltfAttributeReader::Find(JsonValue attributes, const AttributeChannel& channel,
                                              uint64_t vertices) {
  const JsonValue index = attributes.Find(channel.name);
  if (!index.exists()) return nullptr;
  const absl::StatusOr<const GltfAccessor*> accessor = file_.Accessor(index, channel.name);
  if (!accessor.ok() || (*accessor)->count != vertices) return nullptr;
  const int wanted = WantedComponents(RoleOfName(channel.name));
  return wanted == 0 || (*accessor)->components == wanted ? *accessor : nullptr;
}

void GltfAttributeReader::Count(JsonValue primitive, uint64_t vertices) {
  const JsonValue attributes = primitive.Find("attributes");
  wedges_ += vertices;
  for (JsonValue v = attributes.First(); v.exists(); v = v.Next()) {
    AttributeChannel channel{v.Key(), 0};
    if (channel.name == "POSITION" || channel.name.empty() || channel.name.size() > 64) continue;
    const GltfAccessor* const accessor = Find(attributes, channel, vertices);
    if (accessor == nullptr) continue;
    channel.components = static_cast<uint32_t>(accessor->components);
    const auto known =
        std::find_if(channels_.begin(), channels_.end(), [&](const auto& c) { return c.name == channel.name; });
    if (known != channels_.end())
      known->components = std::max(known->components, channel.components);
    else if (channels_.size() < kMaxAttributeChannels)
      channels_.push_back(channel);
  }
  uint64_t stride = 0;
  for (const AttributeChannel& c : channels_) stride += c.components;
  fits_ = wedges_ <= (kMostExpansion * file_.total_bytes() + kFreeBytes) / (4 * std::max<uint64_t>(stride, 1));
}

void GltfAttributeReader::Add(GltfGroup group, JsonValue primitive, const Range& range, TriangleMesh& mesh) {
  MeshAttributes& a = mesh.attributes;
  const JsonValue attributes = primitive.Find("attributes");
  for (const AttributeChannel& c : channels_) {
    if (Find(attributes, c, range.vertices) != nullptr) group.attributes.push_back(c.name);
  }
  fits_ = fits_ && IsRegular(group.to_world);
  a.groups.resize(mesh.triangles.size(), static_cast<uint32_t>(asset_->groups.size()));
  if (fits_ && !channels_.empty()) {
    const std::string key = Concat(group.node, " ", group.mesh, " ", attributes.Raw());
    const auto [first, is_new] = first_wedge_.try_emplace(key, a.wedge_count());
    if (is_new) {
      a.channels = channels_;
      AddWedges(group, attributes, range.vertices, a);
    }
    for (size_t f = range.first_triangle; f < mesh.triangles.size(); ++f) {
      CornerWedges corners;
      for (int i = 0; i < 3; ++i)
        corners[i] = static_cast<uint32_t>(first->second + mesh.triangles[f][i].index() - range.first_vertex);
      a.corners.push_back(corners);
    }
  }
  asset_->groups.push_back(std::move(group));
  names_.push_back(MaterialOf(primitive));
}

// "" where there is none.
std::string GltfAttributeReader::MaterialOf(JsonValue primitive) {
  const uint64_t count = file_.Count("materials"), index = primitive.Find("material").Integer().value_or(count);
  if (index >= count) return "";
  const std::string name = file_.Element("materials", index).Find("name").String();
  return name.empty() ? Concat("material_", index) : name;
}

void GltfAttributeReader::AddWedges(const GltfGroup& group, JsonValue attributes, uint64_t vertices,
                                    MeshAttributes& to) {
  const size_t stride = to.Stride(), begin = to.values.size();
  to.values.resize(begin + stride * vertices);
  size_t offset = 0;
  for (const AttributeChannel& channel : channels_) {
    const GltfAccessor* const accessor = Find(attributes, channel, vertices);
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
