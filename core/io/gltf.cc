// 1. GltfFile checks the container, the JSON and every accessor.
// 2. Walk visits the nodes of the scene with their transforms, without recursion; a node on the path to itself is a cycle.
// 3. The first walk counts what the result will hold (copies are what makes a small file large), the second one fills it.
// Rejected: tinygltf for reading; json.cc says why. The tests read what we write with it.
#include "core/io/gltf.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "absl/container/flat_hash_map.h"
#include "absl/container/flat_hash_set.h"
#include "absl/strings/ascii.h"
#include "core/base/status_macros.h"
#include "core/io/gltf_asset.h"
#include "core/io/gltf_attributes.h"
#include "core/io/gltf_file.h"

namespace meshfront {
namespace {

enum Mode { kPoints = 0, kTriangles = 4, kStrip = 5, kFan = 6 };
constexpr uint64_t kMostExpansion = 16, kFreeBytes = 32 << 20;  // of the result over the file

// p ↦ x·p.x + y·p.y + z·p.z + origin.
struct Transform {
  Vec3 x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1}, origin;

  Vec3 Direction(const Vec3& d) const { return d.x * x + d.y * y + d.z * z; }
  Vec3 Point(const Vec3& p) const { return Direction(p) + origin; }
  Transform After(const Transform& first) const {
    return {Direction(first.x), Direction(first.y), Direction(first.z), Point(first.origin)};
  }
  bool Mirrors() const { return Dot(Cross(x, y), z) < 0; }
  // Normals are carried by the cofactors, whose sign a mirror turns.
  Vec3 Normal(const Vec3& n) const {
    return (Mirrors() ? -1.0 : 1.0) * (n.x * Cross(y, z) + n.y * Cross(z, x) + n.z * Cross(x, y));
  }
};

// Numbers of a JSON array into `out`; false unless there are exactly so many. A missing array leaves the defaults.
bool ReadNumbers(JsonValue array, absl::Span<double> out) {
  if (!array.exists()) return true;
  if (!array.is_array() || array.size() != out.size()) return false;
  size_t i = 0;
  for (JsonValue v = array.First(); v.exists(); v = v.Next(), ++i) {
    if (!v.Number()) return false;
    out[i] = *v.Number();
  }
  return true;
}

Transform FromQuaternion(double x, double y, double z, double w) {
  const double norm = x * x + y * y + z * z + w * w;
  const double s = norm > 0 ? 2 / norm : 0;
  return {{1 - s * (y * y + z * z), s * (x * y + z * w), s * (x * z - y * w)},
          {s * (x * y - z * w), 1 - s * (x * x + z * z), s * (y * z + x * w)},
          {s * (x * z + y * w), s * (y * z - x * w), 1 - s * (x * x + y * y)},
          {}};
}

struct Primitive {
  const GltfAccessor* positions = nullptr;
  const GltfAccessor* normals = nullptr;  // null unless usable for a point set
  const GltfAccessor* indices = nullptr;  // null: 0, 1, 2, …
  uint64_t mode = kTriangles;
  JsonValue json;
  uint64_t number = 0;
  std::string where;

  uint64_t corners() const { return indices != nullptr ? indices->count : positions->count; }
  bool is_surface() const { return mode >= kTriangles; }
  uint64_t triangles() const {
    const uint64_t n = corners();
    return mode == kTriangles ? n / 3 : is_surface() && n > 2 ? n - 2 : 0;
  }
};

class SceneReader {
 public:
  SceneReader(const Source& source, GltfFile& file) : source_(source), file_(file), attributes_(file) {}

  absl::StatusOr<ReadResult> Read() {
    MESHFRONT_RETURN_IF_ERROR(
        Walk([this](JsonValue mesh, uint64_t index, const Transform&) { return CountMesh(mesh, index); }));
    points_only_ = triangles_ == 0;
    const uint64_t vertices = points_only_ ? point_vertices_ : vertices_;
    if (vertices == 0) return Refuse(source_, "has no triangles and no points in its scene");
    if (vertices >= Id<void>::kInvalid) return Refuse(source_, "has ", vertices, " vertices; the most is 4294967294");
    const uint64_t limit = kMostExpansion * file_.total_bytes() + kFreeBytes;
    if (vertices > limit / sizeof(Vec3) || triangles_ > (limit - vertices * sizeof(Vec3)) / sizeof(Triangle)) {
      return Refuse(source_, "its nodes copy its meshes to ", vertices, " vertices and ", triangles_,
                    " triangles, more than ", kMostExpansion, " times the file");
    }
    result_.mesh.positions.reserve(vertices);
    result_.mesh.triangles.reserve(triangles_);
    MESHFRONT_RETURN_IF_ERROR(
        Walk([this](JsonValue mesh, uint64_t index, const Transform& t) { return AddMesh(mesh, index, t); }));
    if (result_.mesh.normals.size() != result_.mesh.positions.size()) result_.mesh.normals = {};
    if (!points_only_) attributes_.Finish(result_);
    NoteRest();
    return std::move(result_);
  }

 private:
  using Visit = std::function<absl::Status(JsonValue mesh, uint64_t index, const Transform&)>;

  // The roots: of the named or first scene; without scenes, nodes that are nobody's child; without nodes, the meshes themselves.
  absl::Status Walk(const Visit& visit) {
    visits_left_ = 16 * file_.Count("nodes") + 1000;
    on_path_.assign(file_.Count("nodes"), false);
    if (file_.Count("nodes") == 0) {
      for (uint64_t i = 0; i < file_.Count("meshes"); ++i)
        MESHFRONT_RETURN_IF_ERROR(visit(file_.Element("meshes", i), i, {}));
      return absl::OkStatus();
    }
    if (file_.Count("scenes") == 0) return WalkOrphans(visit);
    const JsonValue named = file_.root().Find("scene");
    const uint64_t scene = named.exists() ? named.Integer().value_or(file_.Count("scenes")) : 0;
    if (scene >= file_.Count("scenes"))
      return Refuse(source_, "scene is ", named.Excerpt(), "; there are ", file_.Count("scenes"));
    const JsonValue nodes = file_.Element("scenes", scene).Find("nodes");
    for (JsonValue v = nodes.First(); v.exists(); v = v.Next()) {
      MESHFRONT_RETURN_IF_ERROR(WalkFrom(v, Concat("scenes[", scene, "].nodes"), visit));
    }
    return absl::OkStatus();
  }

  absl::Status WalkOrphans(const Visit& visit) {
    std::vector<bool> is_child(file_.Count("nodes"));
    for (uint64_t i = 0; i < is_child.size(); ++i) {
      const JsonValue children = file_.Element("nodes", i).Find("children");
      for (JsonValue v = children.First(); v.exists(); v = v.Next()) {
        const uint64_t child = v.Integer().value_or(is_child.size());
        if (child < is_child.size()) is_child[child] = true;
      }
    }
    bool found = false;
    for (uint64_t i = 0; i < is_child.size(); ++i) {
      if (is_child[i]) continue;
      found = true;
      MESHFRONT_RETURN_IF_ERROR(WalkFrom(i, visit));
    }
    return found ? absl::OkStatus() : Refuse(source_, "every node is the child of another: nodes form a cycle");
  }

  absl::Status WalkFrom(JsonValue node, const std::string& where, const Visit& visit) {
    const uint64_t count = file_.Count("nodes");
    if (node.Integer().value_or(count) >= count)
      return Refuse(source_, where, " names node ", node.Excerpt(), "; there are ", count);
    return WalkFrom(*node.Integer(), visit);
  }

  struct Frame {
    uint64_t node;
    JsonValue next_child;
    Transform transform;
  };

  absl::Status WalkFrom(uint64_t root, const Visit& visit) {
    MESHFRONT_RETURN_IF_ERROR(Enter(root, Transform(), visit));
    while (!path_.empty()) {
      Frame& top = path_.back();
      const JsonValue child = top.next_child;
      if (!child.exists()) {
        on_path_[top.node] = false;
        path_.pop_back();
        continue;
      }
      top.next_child = child.Next();
      const uint64_t count = file_.Count("nodes"), index = child.Integer().value_or(count);
      if (index >= count)
        return Refuse(source_, "nodes[", top.node, "].children names node ", child.Excerpt(), "; there are ", count);
      if (on_path_[index])
        return Refuse(source_, "nodes[", top.node, "].children names node ", index, ", which is above it: a cycle");
      const Transform transform = top.transform;  // Enter moves the stack
      MESHFRONT_RETURN_IF_ERROR(Enter(index, transform, visit));
    }
    return absl::OkStatus();
  }

  absl::Status Enter(uint64_t index, const Transform& parent, const Visit& visit) {
    if (visits_left_-- == 0)
      return Refuse(source_, "nodes[", index, "]: nodes are named as children so often that their copies explode");
    const JsonValue node = file_.Element("nodes", index);
    Transform local;
    MESHFRONT_RETURN_IF_ERROR(ReadTransform(node, index, local));
    on_path_[index] = true;
    path_.push_back({index, node.Find("children").First(), parent.After(local)});
    const JsonValue mesh = node.Find("mesh");
    if (!mesh.exists()) return absl::OkStatus();
    const uint64_t count = file_.Count("meshes");
    if (mesh.Integer().value_or(count) >= count) {
      return Refuse(source_, "nodes[", index, "].mesh is ", mesh.Excerpt(), "; there are ", count);
    }
    return visit(file_.Element("meshes", *mesh.Integer()), *mesh.Integer(), path_.back().transform);
  }

  absl::Status ReadTransform(JsonValue node, uint64_t index, Transform& t) {
    double m[16], move[3] = {0, 0, 0}, turn[4] = {0, 0, 0, 1}, scale[3] = {1, 1, 1};
    const JsonValue matrix = node.Find("matrix");
    if (!ReadNumbers(matrix, m) || !ReadNumbers(node.Find("translation"), move) ||
        !ReadNumbers(node.Find("rotation"), turn) || !ReadNumbers(node.Find("scale"), scale)) {
      return Refuse(source_, "nodes[", index, "] has a transform that is not 16, 3, 4 or 3 numbers");
    }
    if (matrix.exists()) {
      t = {{m[0], m[1], m[2]}, {m[4], m[5], m[6]}, {m[8], m[9], m[10]}, {m[12], m[13], m[14]}};
      return absl::OkStatus();
    }
    t = FromQuaternion(turn[0], turn[1], turn[2], turn[3]);
    t.x *= scale[0], t.y *= scale[1], t.z *= scale[2];
    t.origin = {move[0], move[1], move[2]};
    return absl::OkStatus();
  }

  absl::StatusOr<Primitive> ReadPrimitive(JsonValue json, uint64_t mesh, uint64_t number) {
    Primitive p;
    p.where = Concat("meshes[", mesh, "].primitives[", number, "]");
    p.json = json, p.number = number;
    const JsonValue mode = json.Find("mode"), attributes = json.Find("attributes"), indices = json.Find("indices");
    p.mode = mode.exists() ? mode.Integer().value_or(99) : uint64_t{kTriangles};
    if (p.mode > kFan) return Refuse(source_, p.where, ".mode is ", mode.Excerpt(), "; it must be 0 to 6");
    const JsonValue position = attributes.Find("POSITION");
    if (file_.document().exhausted())
      return Refuse(source_, p.where, ": the JSON refers to its own large parts too often");
    if (!position.exists()) return Refuse(source_, p.where, ".attributes has no POSITION");
    MESHFRONT_ASSIGN_OR_RETURN(p.positions, file_.Accessor(position, p.where + ".attributes.POSITION"));
    if (p.positions->components != 3) {
      return Refuse(source_, p.where, ".attributes.POSITION has ", p.positions->components,
                    " numbers an element; it must have 3");
    }
    if (indices.exists()) {
      MESHFRONT_ASSIGN_OR_RETURN(p.indices, file_.Accessor(indices, p.where + ".indices"));
      const int type = p.indices->component_type;
      if (p.indices->components != 1 || (type != 5121 && type != 5123 && type != 5125)) {
        return Refuse(source_, p.where, ".indices must be single unsigned integers");
      }
    }
    if (p.mode == kTriangles && p.corners() % 3 != 0) {
      return Refuse(source_, p.where, " has ", p.corners(), " corners; triangles need a multiple of 3");
    }
    if (p.is_surface() || !attributes.Find("NORMAL").exists()) return p;
    MESHFRONT_ASSIGN_OR_RETURN(p.normals, file_.Accessor(attributes.Find("NORMAL"), p.where + ".attributes.NORMAL"));
    if (p.normals->components != 3 || p.normals->count != p.positions->count) p.normals = nullptr;
    return p;
  }

  template <class Body>
  absl::Status ForEachPrimitive(JsonValue mesh, uint64_t index, const Body& body) {
    uint64_t number = 0;
    for (JsonValue json = mesh.Find("primitives").First(); json.exists(); json = json.Next(), ++number) {
      MESHFRONT_ASSIGN_OR_RETURN(const Primitive p, ReadPrimitive(json, index, number));
      MESHFRONT_RETURN_IF_ERROR(body(json, p));
    }
    return absl::OkStatus();
  }

  absl::Status CountMesh(JsonValue mesh, uint64_t index) {
    // Sums stay far from overflow: a step adds less than the file has bytes, and there are fewer steps than that.
    absl::flat_hash_set<const GltfAccessor*> of_surfaces, of_points;
    return ForEachPrimitive(mesh, index, [&](JsonValue json, const Primitive& p) {
      const bool is_new = (p.is_surface() ? of_surfaces : of_points).insert(p.positions).second;
      if (is_new) (p.is_surface() ? vertices_ : point_vertices_) += p.positions->count;
      triangles_ += p.triangles();
      if (p.is_surface() && p.triangles() > 0) attributes_.Count(json, p.positions->count);
      NoteAttributes(json);
      return absl::OkStatus();
    });
  }

  // Primitives that use the same positions share their vertices.
  absl::Status AddMesh(JsonValue mesh, uint64_t index, const Transform& transform) {
    shared_.clear();
    return ForEachPrimitive(mesh, index, [&](JsonValue, const Primitive& p) -> absl::Status {
      if (p.is_surface() == points_only_) return NotePoints(p);
      TriangleMesh& out = result_.mesh;
      const auto [place, is_new] = shared_.emplace(p.positions, static_cast<uint32_t>(out.positions.size()));
      if (is_new) {
        for (uint64_t i = 0; i < p.positions->count; ++i)
          out.positions.push_back(transform.Point(p.positions->VectorAt(i)));
        for (uint64_t i = 0; p.normals != nullptr && i < p.normals->count; ++i) {
          out.normals.push_back(transform.Normal(p.normals->VectorAt(i)));
        }
      }
      if (!p.is_surface() || p.triangles() == 0) return absl::OkStatus();
      const size_t before = out.triangles.size();
      MESHFRONT_RETURN_IF_ERROR(AddTriangles(p, place->second, transform.Mirrors()));
      const int64_t node = path_.empty() ? -1 : static_cast<int64_t>(path_.back().node);
      attributes_.Add({node, index, p.number, {transform.x, transform.y, transform.z, transform.origin}, {}}, p.json,
                      {before, place->second, p.positions->count}, out);
      return absl::OkStatus();
    });
  }

  absl::Status NotePoints(const Primitive& p) {
    if (!points_only_ && !p.is_surface()) NoteDropped(result_.mesh, "points and lines");
    return absl::OkStatus();
  }

  absl::Status AddTriangles(const Primitive& p, uint32_t base, bool mirrored) {
    std::vector<Triangle>& out = result_.mesh.triangles;
    auto corner = [&](uint64_t i) { return p.indices != nullptr ? p.indices->IndexAt(i) : static_cast<uint32_t>(i); };
    for (uint64_t i = 0; p.indices != nullptr && i < p.indices->count; ++i) {
      if (corner(i) < p.positions->count) continue;
      return Refuse(source_, p.where, ".indices: element ", i, " is ", corner(i), ", but there are ",
                    p.positions->count, " positions");
    }
    for (uint64_t i = 0; i < p.triangles(); ++i) {
      uint64_t a = p.mode == kTriangles ? 3 * i : p.mode == kStrip ? i : 0;
      uint64_t b = p.mode == kTriangles ? 3 * i + 1 : i + 1, c = b + 1;
      if (p.mode == kStrip && i % 2 == 1) std::swap(a, b);
      if (mirrored) std::swap(b, c);
      const uint32_t u = corner(a), v = corner(b), w = corner(c);
      if (p.mode == kStrip && (u == v || v == w || w == u)) continue;  // it only leads on
      out.push_back({VertexId(base + u), VertexId(base + v), VertexId(base + w)});
    }
    return absl::OkStatus();
  }

  void NoteAttributes(JsonValue json) {
    for (JsonValue v = json.Find("attributes").First(); v.exists(); v = v.Next()) {
      const std::string name = absl::AsciiStrToLower(v.Key());
      if (name != "position" && result_.mesh.dropped_attributes.size() < 64) NoteDropped(result_.mesh, name);
    }
    if (json.Find("targets").exists()) NoteDropped(result_.mesh, "morph targets");
  }

  // What was noted, unless it is among the attributes.
  void NoteRest() {
    for (const AttributeChannel& c : result_.mesh.attributes.channels)
      std::erase(result_.mesh.dropped_attributes, absl::AsciiStrToLower(c.name));
    if (!points_only_ && attributes_.carries_morphs()) std::erase(result_.mesh.dropped_attributes, "morph targets");
    if (points_only_ && file_.root().Find("animations").size() > 0) NoteDropped(result_.mesh, "animations");
    if (result_.mesh.normals.empty()) return;
    std::vector<std::string>& dropped = result_.mesh.dropped_attributes;
    dropped.erase(std::remove(dropped.begin(), dropped.end(), "normal"), dropped.end());
  }

  const Source& source_;
  GltfFile& file_;
  GltfAttributeReader attributes_;
  ReadResult result_;
  std::vector<Frame> path_;
  std::vector<bool> on_path_;
  absl::flat_hash_map<const GltfAccessor*, uint32_t> shared_;  // positions of the mesh at hand → its first vertex
  uint64_t visits_left_ = 0, vertices_ = 0, point_vertices_ = 0, triangles_ = 0;
  bool points_only_ = false;
};

}  // namespace

bool IsGlb(const Source& source) { return source.text().substr(0, 4) == "glTF"; }

bool IsGltf(const Source& source) {
  std::string_view text = source.text().substr(0, 4096);
  if (text.substr(0, 3) == "\xef\xbb\xbf") text.remove_prefix(3);
  const size_t at = text.find_first_not_of(" \t\r\n");
  return at != std::string_view::npos && text[at] == '{';
}

absl::StatusOr<ReadResult> ReadGlb(const Source& source) {
  MESHFRONT_ASSIGN_OR_RETURN(const std::unique_ptr<GltfFile> file, GltfFile::OpenGlb(source));
  return SceneReader(source, *file).Read();
}

absl::StatusOr<ReadResult> ReadGltf(const Source& source) {
  MESHFRONT_ASSIGN_OR_RETURN(const std::unique_ptr<GltfFile> file, GltfFile::OpenGltf(source));
  return SceneReader(source, *file).Read();
}

}  // namespace meshfront
