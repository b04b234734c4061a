// Texture coordinates, normals and materials of an OBJ's faces, which may come before what they name.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "absl/container/flat_hash_map.h"
#include "absl/types/span.h"
#include "core/geometry/vec3.h"
#include "core/mesh/triangle_mesh.h"

namespace meshfront {

class ObjAttributes {
 public:
  void AddTexcoord(double u, double v) { texcoords_.push_back({static_cast<float>(u), static_cast<float>(v)}); }
  void AddNormal(const Vec3& n) {
    normals_.push_back({static_cast<float>(n.x), static_cast<float>(n.y), static_cast<float>(n.z)});
  }
  void UseMaterial(const std::string& name);
  // Of a corner, by what follows its vertex: "", "/vt", "//vn" or "/vt/vn".
  uint32_t WedgeOf(std::string_view rest);
  // Takes over what became of a face: the triangles of the mesh that were not there at the call before.
  void AddFace(absl::Span<const uint32_t> vertices, absl::Span<const uint32_t> wedges, const TriangleMesh& mesh);

  // Once, in this order.
  MeshAttributes Take(size_t triangles);
  std::vector<std::string> TakeMaterials();
  uint64_t missing() const { return missing_; }

 private:
  static constexpr uint32_t kNone = 0xffffffffu;
  using Names = std::pair<uint32_t, uint32_t>;  // of a texture coordinate and a normal

  static uint32_t Resolve(int64_t value, size_t count);

  std::vector<std::array<float, 2>> texcoords_;
  std::vector<std::array<float, 3>> normals_;
  absl::flat_hash_map<Names, uint32_t> known_;
  std::vector<Names> wedges_;
  std::vector<CornerWedges> corners_;
  std::vector<uint32_t> groups_;
  absl::flat_hash_map<std::string, uint32_t> known_materials_;
  std::vector<std::string> materials_;
  uint32_t material_ = kNone;
  bool has_texcoords_ = false, has_normals_ = false;
  uint64_t missing_ = 0;
};

}  // namespace meshfront
