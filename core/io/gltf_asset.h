// A glTF around another mesh: nodes, materials, textures, animations, skins and extras as they were, the primitives new.
#pragma once

#include <cmath>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/types/span.h"
#include "core/geometry/vec3.h"
#include "core/io/mesh_io.h"
#include "core/mesh/triangle_mesh.h"

namespace meshfront {

// p ↦ x·p.x + y·p.y + z·p.z + origin.
struct GltfTransform {
  Vec3 x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1}, origin;
};

// Whether a normal or tangent passes with its bits: it is of unit length but for rounding, and nothing turns it.
inline bool KeepsBits(const GltfTransform& t, const Vec3& direction) {
  constexpr double rounding = 1e-3;
  return t.x == Vec3{1, 0, 0} && t.y == Vec3{0, 1, 0} && t.z == Vec3{0, 0, 1} &&
         std::abs(SquaredNorm(direction) - 1) < rounding;
}

// A primitive as a node has it: where the faces of one group of the mesh come from.
struct GltfGroup {
  int64_t node = -1;  // -1: the file has no nodes, and the mesh stands alone
  uint64_t mesh = 0, primitive = 0;
  GltfTransform to_world;  // of the positions in the file
  std::vector<std::string>
      attributes;        // that the primitive has, beside POSITION; those of morph targets behind all others
  uint32_t targets = 0;  // morph targets; 0 as well where they can't be carried
};

struct GltfAsset {
  std::string json;
  std::map<uint64_t, std::string> views;  // bytes of the buffer views of images, animations and skins
  std::vector<GltfGroup> groups;          // by MeshAttributes::groups
};

// The document and the one buffer that it names without a uri.
struct GltfDocument {
  std::string json_before_uri, json_after_uri;  // `"uri":"…",` may go in between
  std::string buffer;
};

// Meshes with the groups of the asset, in the coordinates that it was read in; of several, at least one, the first is what nodes have and
// the others are its levels of detail (MSFT_lod). What of the asset goes is appended to `left_out`.
absl::StatusOr<GltfDocument> FormatGltf(absl::Span<const DetailLevel> levels, const GltfAsset& asset,
                                        std::vector<std::string>& left_out);
// The images that lie in files of their own, by their uris.
std::vector<std::string> ImageFilesOf(const GltfAsset& asset);
// For meshes of other formats: one node, a material for each name.
GltfAsset PlainGltfAsset(const TriangleMesh& mesh, const std::vector<std::string>& group_names);

}  // namespace meshfront
