// 1. the references that stay: images, animations, skins, and their views and accessors behind each other in one buffer
// 2. the faces of each group, their vertices split where wedges differ, back in the coordinates of their node
// 3. a mesh for each node: instances of a mesh are different meshes from now on
// 4. of levels of detail, a node beside it for each further level, that MSFT_lod names
#include "core/io/gltf_asset.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <utility>

#include "absl/container/flat_hash_map.h"
#include "absl/strings/match.h"
#include "absl/types/span.h"
#include "core/geometry/box.h"
#include "core/io/gltf_buffer.h"
#include "core/io/source.h"

namespace meshfront {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kFarDiagonals = 4;  // from the origin: from there on float32 loses bits of the shape

void Note(std::vector<std::string>& list, const std::string& what) {
  if (std::find(list.begin(), list.end(), what) == list.end()) list.push_back(what);
}

Json* Member(Json& object, const char* key) {
  if (!object.is_object()) return nullptr;
  const auto found = object.find(key);
  return found == object.end() ? nullptr : &*found;
}
// Elements of an array member; none where it is missing.
template <class Visit>
void ForEach(Json& object, const char* key, Visit visit) {
  Json* const array = Member(object, key);
  if (array == nullptr || !array->is_array()) return;
  for (Json& element : *array) visit(element);
}
std::optional<uint64_t> IndexIn(Json& object, const char* key) {
  Json* const value = Member(object, key);
  if (value == nullptr || !value->is_number_integer() || value->get<int64_t>() < 0) return std::nullopt;
  return value->get<uint64_t>();
}

struct Inverse {
  explicit Inverse(const GltfTransform& t)
      : origin(t.origin),
        yz(Cross(t.y, t.z)),
        zx(Cross(t.z, t.x)),
        xy(Cross(t.x, t.y)),
        determinant(Dot(yz, t.x)),
        to(t) {}
  Vec3 Direction(const Vec3& d) const { return Vec3{Dot(yz, d), Dot(zx, d), Dot(xy, d)} / determinant; }
  Vec3 Point(const Vec3& p) const { return Direction(p - origin); }
  // Normals go with the transposed inverse there, and so with the transpose back.
  Vec3 Normal(const Vec3& n) const { return Normalized(Vec3{Dot(to.x, n), Dot(to.y, n), Dot(to.z, n)}); }
  bool mirrors() const { return determinant < 0; }

  Vec3 origin, yz, zx, xy;
  double determinant;
  GltfTransform to;
};

class Formatter {
 public:
  // At least one level; all outlive it.
  Formatter(absl::Span<const DetailLevel> levels, const GltfAsset& asset, std::vector<std::string>& left_out)
      : levels_(levels), asset_(asset), left_out_(left_out) {}

  absl::StatusOr<GltfDocument> Format() {
    doc_ = Json::parse(asset_.json, nullptr, false);
    if (!doc_.is_object()) return absl::InternalError("a glTF that was read can't be read again; please report it");
    old_accessors_ = TakeMember("accessors"), old_views_ = TakeMember("bufferViews");
    old_meshes_ = TakeMember("meshes");
    for (const DetailLevel& level : levels_) {
      mesh_ = level.mesh;
      const absl::Status placed = PlaceGroups();
      if (!placed.ok()) return placed;
    }
    KeepAnimations();
    KeepReferences();
    CleanNodes();
    if (levels_.size() > 1) AddLevels();
    doc_["meshes"] = std::move(meshes_);
    doc_["accessors"] = std::move(buffer_.accessors);
    doc_["bufferViews"] = std::move(buffer_.views);
    static constexpr const char* kMark = "@meshfront-uri@";
    doc_["buffers"] = Json::array({Json{{"uri", kMark}, {"byteLength", buffer_.bytes.size()}}});
    const std::string text = doc_.dump(-1, ' ', false, Json::error_handler_t::replace);
    const std::string mark = std::string("\"uri\":\"") + kMark + "\",";
    const size_t at = text.rfind(mark);
    return GltfDocument{text.substr(0, at), text.substr(at + mark.size()), std::move(buffer_.bytes)};
  }

 private:
  using Place = std::pair<int64_t, uint64_t>;  // a node and a mesh of the file
  static constexpr const char* kLodExtension = "MSFT_lod";
  static constexpr const char* kCoverage = "MSFT_screencoverage";

  Json TakeMember(const char* key) {
    Json* const found = Member(doc_, key);
    Json taken = found == nullptr ? Json::array() : std::move(*found);
    doc_.erase(key);
    return taken;
  }

  // The numbers of views and accessors that stay are new.
  void MoveView(Json& object, const char* key) {
    const std::optional<uint64_t> index = IndexIn(object, key);
    if (!index) return;
    const auto [at, is_new] = moved_views_.try_emplace(*index, 0);
    if (is_new) {
      const auto bytes = asset_.views.find(*index);
      at->second = buffer_.AddView(bytes == asset_.views.end() ? absl::string_view() : absl::string_view(bytes->second),
                                   kGltfNoTarget);
      if (*index < old_views_.size()) {
        for (const char* kept : {"byteStride", "name", "extras"}) {
          if (Json* const value = Member(old_views_[*index], kept)) buffer_.views[at->second][kept] = *value;
        }
      }
    }
    object[key] = at->second;
  }
  void MoveAccessor(Json& object, const char* key) {
    const std::optional<uint64_t> index = IndexIn(object, key);
    if (!index || *index >= old_accessors_.size()) return;
    const auto [at, is_new] = moved_accessors_.try_emplace(*index, 0);
    if (is_new) {
      Json accessor = old_accessors_[*index];
      MoveView(accessor, "bufferView");
      DropPlainStride(accessor);
      if (Json* const sparse = Member(accessor, "sparse")) {
        for (const char* part : {"indices", "values"}) {
          if (Json* const json = Member(*sparse, part)) MoveView(*json, "bufferView");
        }
      }
      buffer_.accessors.push_back(std::move(accessor));
      at->second = buffer_.accessors.size() - 1;
    }
    object[key] = at->second;
  }

  // Where elements lie behind each other a stride says nothing, and for animations and skins it is forbidden.
  void DropPlainStride(Json& accessor) {
    const std::optional<uint64_t> view = IndexIn(accessor, "bufferView"), type = IndexIn(accessor, "componentType");
    if (!view || !type || Member(accessor, "type") == nullptr) return;
    const uint64_t bytes = *type >= kGltfUint32 ? 4 : *type >= 5122 ? 2 : 1;
    static const std::map<std::string, uint64_t> kCounts = {{"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3},
                                                            {"VEC4", 4},   {"MAT3", 9}, {"MAT4", 16}};
    const auto count = kCounts.find(Member(accessor, "type")->get<std::string>());
    const std::optional<uint64_t> stride = IndexIn(buffer_.views[*view], "byteStride");
    if (count != kCounts.end() && stride && *stride == count->second * bytes) buffer_.views[*view].erase("byteStride");
  }

  // Morph targets of a mesh as it is written.
  uint32_t TargetsOf(size_t mesh) {
    uint32_t targets = 0;
    ForEach(meshes_[mesh], "primitives", [&](Json& primitive) {
      if (const Json* const list = Member(primitive, "targets")) targets = static_cast<uint32_t>(list->size());
    });
    return targets;
  }

  // Those of weights need morph targets to move.
  void KeepAnimations() {
    Json* const animations = Member(doc_, "animations");
    if (animations == nullptr || !animations->is_array()) return;
    std::set<uint64_t> morphing;
    for (const auto& [place, mesh] : placed_.front()) {
      if (place.first >= 0 && TargetsOf(mesh) > 0) morphing.insert(static_cast<uint64_t>(place.first));
    }
    Json kept = Json::array();
    for (Json& animation : *animations) {
      Json channels = Json::array();
      ForEach(animation, "channels", [&](Json& channel) {
        if (!MovesWeights(channel) || morphing.count(IndexIn(channel["target"], "node").value_or(-1)) > 0)
          channels.push_back(channel);
        else
          Note(left_out_, "animations of morph targets");
      });
      if (channels.empty()) continue;
      animation["channels"] = std::move(channels);
      kept.push_back(std::move(animation));
    }
    if (kept.empty())
      doc_.erase("animations");
    else
      *animations = std::move(kept);
  }

  static bool MovesWeights(Json& channel) {
    Json* const target = Member(channel, "target");
    return target != nullptr && Member(*target, "path") != nullptr && *Member(*target, "path") == "weights";
  }

  void KeepReferences() {
    ForEach(doc_, "animations", [&](Json& animation) {
      ForEach(animation, "samplers",
              [&](Json& sampler) { MoveAccessor(sampler, "input"), MoveAccessor(sampler, "output"); });
    });
    ForEach(doc_, "skins", [&](Json& skin) { MoveAccessor(skin, "inverseBindMatrices"); });
    ForEach(doc_, "images", [&](Json& image) { MoveView(image, "bufferView"); });
  }

  absl::Status PlaceGroups() {
    std::vector<std::vector<uint32_t>> faces(asset_.groups.size());
    for (uint32_t f = 0; f < mesh_->triangles.size(); ++f) {
      const uint32_t group = mesh_->attributes.GroupOf(f);
      if (group >= faces.size())
        return absl::InvalidArgumentError(Concat("triangle ", f, " is of group ", group, "; there are ", faces.size()));
      faces[group].push_back(f);
    }
    FindSlots();
    const std::map<Place, uint32_t> targets = CountTargets(faces);
    std::map<Place, size_t>& mesh_of = placed_.emplace_back();
    for (size_t g = 0; g < faces.size(); ++g) {
      const GltfGroup& group = asset_.groups[g];
      if (faces[g].empty()) continue;
      const auto [at, is_new] = mesh_of.try_emplace({group.node, group.mesh}, meshes_.size());
      Json old = group.mesh < old_meshes_.size() ? old_meshes_[group.mesh] : Json::object();
      Json* const primitives = Member(old, "primitives");
      Json primitive = primitives != nullptr && group.primitive < primitives->size() ? (*primitives)[group.primitive]
                                                                                     : Json::object();
      if (is_new) {
        DropExtensions(old);
        old["primitives"] = Json::array();
        meshes_.push_back(std::move(old));
      }
      FillPrimitive(group, faces[g], targets.at({group.node, group.mesh}), primitive);
      meshes_[at->second]["primitives"].push_back(std::move(primitive));
    }
    for (const auto& [place, mesh] : mesh_of) KeepWeights(meshes_[mesh], TargetsOf(mesh));
    return absl::OkStatus();
  }

  // Of what is written of the mesh at hand: all primitives of a mesh have the same number of targets.
  std::map<Place, uint32_t> CountTargets(const std::vector<std::vector<uint32_t>>& faces) const {
    std::map<Place, uint32_t> targets;
    for (size_t g = 0; g < faces.size(); ++g) {
      uint32_t& of_place = targets[{asset_.groups[g].node, asset_.groups[g].mesh}];
      if (!faces[g].empty()) of_place = std::max(of_place, asset_.groups[g].targets);
    }
    return targets;
  }

  // As many weights as targets, or none: then all are 0.
  static void KeepWeights(Json& object, uint32_t targets) {
    const Json* const weights = Member(object, "weights");
    if (weights == nullptr) return;
    if (targets == 0 || !weights->is_array() || weights->size() != targets) object.erase("weights");
  }

  // Where the channels of the mesh at hand are in a wedge.
  void FindSlots() {
    slots_.clear();
    uint32_t offset = 0;
    for (const AttributeChannel& c : mesh_->attributes.channels) {
      slots_[c.name] = {offset, c.components};
      offset += c.components;
    }
  }

  // What extensions of meshes and primitives say of vertices and accessors is of the old ones. Variants name materials only.
  void DropExtensions(Json& object) {
    Json* const extensions = Member(object, "extensions");
    if (extensions == nullptr) return;
    Json kept = Json::object();
    for (auto e = extensions->begin(); extensions->is_object() && e != extensions->end(); ++e) {
      if (e.key() == "KHR_materials_variants") {
        kept[e.key()] = e.value();
        continue;
      }
      dropped_extensions_.insert(e.key());
      if (e.key() != "KHR_draco_mesh_compression") Note(left_out_, e.key());  // that was read
    }
    if (kept.empty())
      object.erase("extensions");
    else
      *extensions = std::move(kept);
  }

  void DropLostMaterial(Json& primitive) {
    const std::optional<uint64_t> index = IndexIn(primitive, "material");
    const Json* const materials = Member(doc_, "materials");
    if (!index || (materials != nullptr && *index < materials->size())) return;
    primitive.erase("material");
    Note(left_out_, Concat("material ", *index, ", which the glTF does not have"));
  }

  // Vertices of a primitive: one for each wedge of each vertex of the mesh.
  struct Corner {
    uint32_t vertex, wedge;
  };
  // Of a channel in a wedge.
  struct Slot {
    uint32_t offset, components;
  };

  void FillPrimitive(const GltfGroup& group, const std::vector<uint32_t>& faces, uint32_t targets, Json& primitive) {
    if (primitive.erase("targets") > 0 && targets == 0) Note(left_out_, "morph targets");
    DropExtensions(primitive);
    DropLostMaterial(primitive);
    const Inverse inverse(group.to_world);
    std::vector<Corner> corners;
    std::vector<uint32_t> indices;
    absl::flat_hash_map<uint64_t, uint32_t> number;
    const bool has_wedges = !mesh_->attributes.corners.empty();
    for (const uint32_t f : faces) {
      for (int i : {0, inverse.mirrors() ? 2 : 1, inverse.mirrors() ? 1 : 2}) {
        const Corner corner{mesh_->triangles[f][i].index(), has_wedges ? mesh_->attributes.corners[f][i] : 0};
        const uint64_t key = uint64_t{corner.vertex} << 32 | corner.wedge;
        const auto [at, is_new] = number.try_emplace(key, static_cast<uint32_t>(corners.size()));
        if (is_new) corners.push_back(corner);
        indices.push_back(at->second);
      }
    }
    Json attributes = Json::object();
    attributes["POSITION"] = AddPositions(corners, inverse);
    for (const std::string& name : group.attributes) {
      if (!MorphNameOf(name)) AddAttribute(name, corners, inverse, attributes);
    }
    if (targets > 0) primitive["targets"] = FormatTargets(group, targets, corners, attributes);
    primitive["attributes"] = std::move(attributes);
    primitive["indices"] =
        buffer_.AddAccessor(buffer_.AddArray(indices, kGltfElementArrayBuffer), kGltfUint32, indices.size(), 1);
    primitive["mode"] = 4;
  }

  uint64_t AddPositions(const std::vector<Corner>& corners, const Inverse& inverse) {
    std::vector<float> values;
    for (const Corner& c : corners) {
      const Vec3 p = inverse.Point(mesh_->positions[c.vertex]);
      for (int axis = 0; axis < 3; ++axis) values.push_back(static_cast<float>(p[axis]));
    }
    const uint64_t accessor =
        buffer_.AddAccessor(buffer_.AddArray(values, kGltfArrayBuffer), kGltfFloat, corners.size(), 3);
    buffer_.SetBounds(accessor, values, 3);
    return accessor;
  }

  void AddAttribute(const std::string& name, const std::vector<Corner>& corners, const Inverse& inverse,
                    Json& attributes) {
    const auto slot = slots_.find(name);
    if (slot == slots_.end()) return;
    const uint32_t offset = slot->second.offset;
    uint32_t components = slot->second.components;
    const AttributeRole role = RoleOfName(name);
    if (role == AttributeRole::kTexcoord) components = std::min(components, 2u);
    if (role == AttributeRole::kNormal) components = 3;
    if (components > 4 || (role == AttributeRole::kTexcoord && components < 2)) return Note(left_out_, name);
    if (role == AttributeRole::kJoints) return AddJoints(name, offset, components, corners, attributes);
    std::vector<float> values;
    for (const Corner& c : corners) {
      const absl::Span<const float> wedge = mesh_->attributes.WedgeAt(c.wedge);
      const size_t begin = values.size();
      values.insert(values.end(), wedge.begin() + offset, wedge.begin() + offset + components);
      ToNode(role, inverse, values.data() + begin);
      if (role == AttributeRole::kColour) {
        for (size_t i = begin; i < values.size(); ++i) values[i] = std::clamp(values[i], 0.0f, 1.0f);
      }
    }
    attributes[GltfName(name, role)] =
        buffer_.AddAccessor(buffer_.AddArray(values, kGltfArrayBuffer), kGltfFloat, corners.size(), components);
  }

  // What each target adds to the attributes that are written; one that does nothing adds zeros to POSITION.
  Json FormatTargets(const GltfGroup& group, uint32_t targets, const std::vector<Corner>& corners, Json& attributes) {
    Json list = Json::array();
    for (uint32_t t = 0; t < targets; ++t) list.push_back(Json::object());
    for (const std::string& name : group.attributes) {
      const std::optional<MorphName> morph = MorphNameOf(name);
      const auto slot = slots_.find(name);
      if (!morph || slot == slots_.end() || morph->target >= targets) continue;
      const std::string of = GltfName(std::string(morph->attribute), RoleOfName(morph->attribute));
      const std::string base = of == "_POSITION" ? "POSITION" : of;
      if (Member(attributes, base.c_str()) == nullptr) continue;
      list[morph->target][base] = AddDeltas(slot->second, base, corners);
    }
    for (Json& target : list) {
      if (target.empty()) target["POSITION"] = AddDeltas({0, 0}, "POSITION", corners);
    }
    return list;
  }

  // Missing components are 0: a colour may have more than what is added to it.
  uint64_t AddDeltas(const Slot& slot, const std::string& attribute, const std::vector<Corner>& corners) {
    const AttributeRole role = RoleOfName(attribute);
    const uint32_t components = role == AttributeRole::kTexcoord ? 2
                                : role == AttributeRole::kColour ? std::min(slots_[attribute].components, 4u)
                                : role == AttributeRole::kCustom && attribute != "POSITION" ? slot.components
                                                                                            : 3;
    std::vector<float> values(corners.size() * components, 0);
    for (size_t i = 0; i < corners.size() && slot.components > 0; ++i) {
      const absl::Span<const float> wedge = mesh_->attributes.WedgeAt(corners[i].wedge);
      for (uint32_t c = 0; c < std::min(components, slot.components); ++c)
        values[i * components + c] = wedge[slot.offset + c];
    }
    const uint64_t accessor = buffer_.AddSparse(values, components);
    if (attribute == "POSITION") buffer_.SetBounds(accessor, values, components);
    return accessor;
  }

  // Of applications' own attributes begins with an underscore.
  static std::string GltfName(const std::string& name, AttributeRole role) {
    return role != AttributeRole::kCustom || absl::StartsWith(name, "_") ? name : "_" + name;
  }

  static void ToNode(AttributeRole role, const Inverse& inverse, float* at) {
    if (role != AttributeRole::kNormal && role != AttributeRole::kTangent) return;
    const Vec3 v{at[0], at[1], at[2]};
    if (KeepsBits(inverse.to, v)) return;
    const Vec3 moved = role == AttributeRole::kNormal ? inverse.Normal(v) : Normalized(inverse.Direction(v));
    for (int axis = 0; axis < 3; ++axis) at[axis] = static_cast<float>(moved[axis]);
    if (role == AttributeRole::kTangent) at[3] = (at[3] < 0) != inverse.mirrors() ? -1 : 1;
  }

  void AddJoints(const std::string& name, uint32_t offset, uint32_t components, const std::vector<Corner>& corners,
                 Json& attributes) {
    std::vector<uint16_t> values;
    for (const Corner& c : corners) {
      for (const float v : mesh_->attributes.WedgeAt(c.wedge).subspan(offset, components))
        values.push_back(static_cast<uint16_t>(std::clamp(v, 0.0f, 65535.0f)));
    }
    attributes[name] =
        buffer_.AddAccessor(buffer_.AddArray(values, kGltfArrayBuffer), kGltfUint16, corners.size(), components);
  }

  // Levels of the file's own are outside of the scene, and were not read.
  void DropOldLevels(Json& node) {
    Json* const extensions = Member(node, "extensions");
    if (extensions == nullptr || !extensions->is_object() || extensions->erase(kLodExtension) == 0) return;
    Note(left_out_, "levels of detail of the glTF");
    if (Json* const extras = Member(node, "extras"); extras != nullptr && extras->is_object()) {
      extras->erase(kCoverage);
    }
    const std::string materials = Member(doc_, "materials") == nullptr ? "" : doc_["materials"].dump();
    if (!absl::StrContains(materials, kLodExtension)) dropped_extensions_.insert(kLodExtension);
  }

  // Nodes whose mesh was not read, or of which nothing is left, have none.
  void CleanNodes() {
    std::map<int64_t, size_t> node_meshes;
    for (const auto& [place, mesh] : placed_.front()) node_meshes[place.first] = mesh;
    int64_t number = 0;
    ForEach(doc_, "nodes", [&](Json& node) {
      const auto mesh = node_meshes.find(number++);
      if (!node.is_object()) return;
      KeepWeights(node, mesh == node_meshes.end() ? 0 : TargetsOf(mesh->second));
      DropOldLevels(node);
      if (mesh != node_meshes.end()) {
        node["mesh"] = mesh->second;
      } else if (node.erase("mesh") > 0) {
        node.erase("skin");
        Note(left_out_, "meshes outside of the scene, or without triangles");
      }
      Json* const extensions = Member(node, "extensions");
      if (extensions != nullptr && extensions->erase("EXT_mesh_gpu_instancing") > 0) {
        dropped_extensions_.insert("EXT_mesh_gpu_instancing");
        Note(left_out_, "EXT_mesh_gpu_instancing");
      }
      if (extensions != nullptr && extensions->empty()) node.erase("extensions");
    });
    for (const char* list : {"extensionsUsed", "extensionsRequired"}) {
      Json kept = Json::array();
      ForEach(doc_, list, [&](Json& name) {
        const bool is_dropped = name.is_string() && dropped_extensions_.count(name.get<std::string>()) > 0;
        if (!is_dropped) kept.push_back(name);
      });
      doc_.erase(list);
      if (!kept.empty()) doc_[list] = std::move(kept);
    }
  }

  // Nodes that something else is said of than where a mesh is: what moves or hangs on them is there at every level.
  std::set<uint64_t> BusyNodes() {
    std::set<uint64_t> busy;
    ForEach(doc_, "animations", [&](Json& animation) {
      ForEach(animation, "channels", [&](Json& channel) {
        Json* const target = Member(channel, "target");
        if (target == nullptr || MovesWeights(channel)) return;
        if (const std::optional<uint64_t> node = IndexIn(*target, "node")) busy.insert(*node);
      });
    });
    ForEach(doc_, "skins", [&](Json& skin) {
      ForEach(skin, "joints", [&](Json& joint) {
        if (joint.is_number_unsigned()) busy.insert(joint.get<uint64_t>());
      });
    });
    return busy;
  }

  static Json Picked(const Json& node, std::initializer_list<const char*> keys) {
    Json picked = Json::object();
    for (const char* const key : keys) {
      if (node.contains(key)) picked[key] = node[key];
    }
    return picked;
  }

  // Where the file has no nodes, one for each mesh, in a scene.
  uint64_t AddNodeFor(size_t mesh) {
    Json& nodes = doc_["nodes"];
    if (!nodes.is_array()) nodes = Json::array();
    nodes.push_back({{"mesh", mesh}});
    Json& scenes = doc_["scenes"];
    if (!scenes.is_array() || scenes.empty()) scenes = Json::array({Json{{"nodes", Json::array()}}}), doc_["scene"] = 0;
    scenes[IndexIn(doc_, "scene").value_or(0)]["nodes"].push_back(nodes.size() - 1);
    return nodes.size() - 1;
  }

  // The node that holds the mesh of `node` and nothing else: itself, or a child.
  uint64_t LeafOf(uint64_t node, bool is_busy) {
    Json& nodes = doc_["nodes"];
    const Json& holder = nodes[node];
    is_busy = is_busy || (holder.contains("extras") && !holder["extras"].is_object());
    for (const char* const key : {"children", "camera", "extensions"}) is_busy = is_busy || holder.contains(key);
    if (!is_busy) return node;
    Json leaf = Picked(holder, {"name", "mesh", "skin", "weights"});
    for (const char* const key : {"mesh", "skin", "weights"}) nodes[node].erase(key);
    nodes[node]["children"].push_back(nodes.size());
    nodes.push_back(std::move(leaf));
    return nodes.size() - 1;
  }

  // What moves the weights of the node moves those of its leaf and of all levels.
  void MorphLevels(int64_t node, uint64_t leaf, const Json& levels) {
    ForEach(doc_, "animations", [&](Json& animation) {
      Json more = Json::array();
      ForEach(animation, "channels", [&](Json& channel) {
        if (!MovesWeights(channel) || IndexIn(channel["target"], "node") != static_cast<uint64_t>(node)) return;
        channel["target"]["node"] = leaf;
        for (const Json& level : levels) {
          more.push_back(channel);
          more.back()["target"]["node"] = level;
        }
      });
      for (Json& channel : more) animation["channels"].push_back(std::move(channel));
    });
  }

  // A level takes the place of the node above it, and so has its transform and its skin.
  void AddLevelsAt(uint64_t leaf, const Place& place) {
    Json& nodes = doc_["nodes"];
    Json ids = Json::array(), coverages = Json::array({levels_.front().coverage});
    for (size_t level = 1; level < levels_.size(); ++level) {
      const auto mesh = placed_[level].find(place);
      if (mesh == placed_[level].end()) continue;
      Json node = Picked(nodes[leaf], {"name", "skin", "translation", "rotation", "scale", "matrix", "weights"});
      node["mesh"] = mesh->second;
      if (node.contains("name") && node["name"].is_string())
        node["name"] = Concat(node["name"].get<std::string>(), "_LOD", level);
      ids.push_back(nodes.size());
      coverages.push_back(levels_[level].coverage);
      nodes.push_back(std::move(node));
    }
    if (ids.empty()) return;
    MorphLevels(place.first, leaf, ids);
    nodes[leaf]["extensions"][kLodExtension] = {{"ids", std::move(ids)}};
    nodes[leaf]["extras"][kCoverage] = std::move(coverages);
  }

  void AddLevels() {
    const std::set<uint64_t> busy = BusyNodes();
    for (const auto& [place, mesh] : placed_.front()) {
      const uint64_t node = place.first < 0 ? AddNodeFor(mesh) : static_cast<uint64_t>(place.first);
      AddLevelsAt(LeafOf(node, busy.count(node) > 0), place);
    }
    Json& used = doc_["extensionsUsed"];
    if (!used.is_array()) used = Json::array();
    if (std::find(used.begin(), used.end(), kLodExtension) == used.end()) used.push_back(kLodExtension);
  }

  const absl::Span<const DetailLevel> levels_;
  const TriangleMesh* mesh_ = nullptr;  // of the level at hand
  const GltfAsset& asset_;
  std::vector<std::string>& left_out_;
  Json doc_, old_accessors_, old_views_, old_meshes_;
  Json meshes_ = Json::array();
  GltfBuffer buffer_;
  absl::flat_hash_map<std::string, Slot> slots_;  // of the mesh at hand
  std::map<uint64_t, uint64_t> moved_views_, moved_accessors_;
  std::vector<std::map<Place, size_t>> placed_;  // of each level, the meshes
  std::set<std::string> dropped_extensions_ = {"KHR_draco_mesh_compression", "KHR_mesh_quantization"};
};

}  // namespace

absl::StatusOr<GltfDocument> FormatGltf(absl::Span<const DetailLevel> levels, const GltfAsset& asset,
                                        std::vector<std::string>& left_out) try {
  return Formatter(levels, asset, left_out).Format();
} catch (const nlohmann::json::exception& e) {
  return absl::InternalError(Concat("a glTF can't be put together again: ", e.what()));
}

std::vector<std::string> ImageFilesOf(const GltfAsset& asset) {
  std::vector<std::string> files;
  Json doc = Json::parse(asset.json, nullptr, false);
  ForEach(doc, "images", [&](Json& image) {
    const Json* const uri = Member(image, "uri");
    if (uri == nullptr || !uri->is_string()) return;
    std::string name = uri->get<std::string>();
    if (!absl::StartsWith(name, "data:")) files.push_back(std::move(name));
  });
  return files;
}

GltfAsset PlainGltfAsset(const TriangleMesh& mesh, const std::vector<std::string>& group_names) {
  GltfAsset asset;
  const Box3 box = BoundingBox(mesh);
  Json node = {{"mesh", 0}};
  GltfTransform to_world;
  if (!box.empty() && Norm(box.Center()) > kFarDiagonals * box.Diagonal()) {
    to_world.origin = box.Center();
    node["translation"] = {to_world.origin.x, to_world.origin.y, to_world.origin.z};
  }
  uint32_t groups = 1;
  for (const uint32_t g : mesh.attributes.groups) groups = std::max(groups, g + 1);
  Json primitives = Json::array(), materials = Json::array();
  for (uint32_t g = 0; g < groups; ++g) {
    Json primitive = Json::object();
    if (g < group_names.size() && !group_names[g].empty()) {
      primitive["material"] = materials.size();
      materials.push_back({{"name", group_names[g]}});
    }
    primitives.push_back(std::move(primitive));
    asset.groups.push_back({0, 0, g, to_world, {}});
    GltfGroup& group = asset.groups.back();
    for (const AttributeChannel& c : mesh.attributes.channels) {
      group.attributes.push_back(c.name);
      if (const std::optional<MorphName> morph = MorphNameOf(c.name))
        group.targets = std::max(group.targets, morph->target + 1);
    }
  }
  Json doc = {{"asset", {{"version", "2.0"}, {"generator", "Meshfront"}}},
              {"scene", 0},
              {"scenes", Json::array({Json{{"nodes", Json::array({0})}}})},
              {"nodes", Json::array({std::move(node)})},
              {"meshes", Json::array({Json{{"primitives", std::move(primitives)}}})}};
  if (!materials.empty()) doc["materials"] = std::move(materials);
  asset.json = doc.dump(-1, ' ', false, Json::error_handler_t::replace);
  return asset;
}

}  // namespace meshfront
