// Attributes and groups of a glTF's triangles, and what of the file stays for a later one.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "absl/container/flat_hash_map.h"
#include "absl/container/flat_hash_set.h"
#include "core/io/gltf_asset.h"
#include "core/io/gltf_file.h"
#include "core/io/mesh_io.h"

namespace meshfront {

// Called by the reader of scenes: Count for each primitive as often as it is in the scene, then Add, then Finish once. Attributes that
// can't be read, or would take more than 16 times the file's memory, are left out, never an error.
class GltfAttributeReader {
 public:
  explicit GltfAttributeReader(GltfFile& file) : file_(file) {}

  // A primitive's triangles in the mesh, and its vertices.
  struct Range {
    size_t first_triangle, first_vertex, vertices;
  };

  void Count(JsonValue primitive, uint64_t vertices);
  // Wedges and group of the mesh's triangles from range.first_triangle on.
  void Add(GltfGroup group, JsonValue primitive, const Range& range, TriangleMesh& mesh);
  void Finish(ReadResult& result);
  // Whether morph targets are among the attributes, with all that they change. After Finish.
  bool carries_morphs() const { return fits_ && morphs_fit_ && !lost_morphs_; }

 private:
  using Accessors = absl::flat_hash_map<std::string, const GltfAccessor*>;
  template <class Visit>
  static void VisitNames(JsonValue primitive, const Visit& visit);
  const GltfAccessor* Usable(const std::string& name, JsonValue index, uint64_t vertices);
  bool IsZero(JsonValue index);
  // Channels of all primitives.
  struct ChannelList {
    std::vector<AttributeChannel> channels;
    absl::flat_hash_map<std::string, size_t> index;
    uint64_t stride = 0;
    bool Add(const std::string& name, uint32_t components, size_t most);
  };
  bool Fits(uint64_t stride) const;
  Accessors Open(JsonValue primitive, uint64_t vertices, GltfGroup& group);
  void AddCorners(const GltfGroup& group, JsonValue primitive, const Accessors& accessors, const Range& range,
                  TriangleMesh& mesh);
  void AddWedges(const GltfGroup& group, const Accessors& accessors, uint64_t vertices, MeshAttributes& to);
  std::string MaterialOf(JsonValue primitive);
  bool KeepView(JsonValue index);
  void KeepAccessor(JsonValue index);
  void KeepViews();

  GltfFile& file_;
  ChannelList plain_, morphs_;
  std::vector<AttributeChannel> channels_;  // both, from the first primitive that is added on
  absl::flat_hash_set<uint32_t> counted_;   // primitives
  uint64_t wedges_ = 0, kept_bytes_ = 0, not_finite_ = 0;
  bool fits_ = true;                              // attributes into memory, and what is kept
  bool morphs_fit_ = true, lost_morphs_ = false;  // … with morph targets; and whether one of their accessors is none
  absl::flat_hash_set<int64_t> nodes_;
  std::vector<std::string> names_;
  absl::flat_hash_map<std::string, uint32_t> first_wedge_;  // by node, mesh and the attributes' text
  std::shared_ptr<GltfAsset> asset_ = std::make_shared<GltfAsset>();
};

}  // namespace meshfront
