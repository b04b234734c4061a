// What a mesh falls into where a region of it is remeshed: the region, what surrounds it, and the rest.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "absl/status/statusor.h"
#include "core/mesh/adjacency.h"
#include "core/mesh/triangle_mesh.h"
#include "core/prepared_input.h"
#include "core/region.h"
#include "core/region_blend.h"
#include "core/surface/mesh_surface.h"

namespace meshfront {

inline constexpr uint32_t kNoFace = 0xffffffffu;

// The surroundings are all that the region's curvature, normals and thickness depend on: the region and what lies near it.
struct RegionParts {
  std::shared_ptr<const PreparedInput> input;  // in the input's own scale
  std::vector<uint32_t> chosen_faces;          // of its mesh, in increasing order: the region
  std::vector<bool> chosen;                    // the same as flags
  bool patch_only = false;
  bool keeps_attributes = false;  // there are some, and they are wanted
  std::vector<uint32_t>
      around_vertices;              // of each vertex of the surroundings that one of the whole, where the rest uses it
  std::vector<bool> around_chosen;  // of each face, whether it is in the region
  std::vector<uint32_t> region_faces;    // of each of these that of the whole; kNoFace: mending changed it
  std::vector<uint32_t> region_origins;  // … and the one that it is, or that it was made of
  std::shared_ptr<MeshSurface> around;   // their surface, in the scale of the region's
  std::optional<RegionBlend> blend;
  std::vector<double> diagonals;  // of the component of each face of the surroundings, at the input's scale
  uint64_t changed_outside = 0,
           dropped_outside = 0;  // faces of the input beside the region that repair changed, and dropped
  RegionReport report;

  const TriangleMesh& whole() const { return input->mesh(); }
};

// Takes the surroundings out of the whole, with the origins of their faces there, and their attributes where those are kept:
// faces with a vertex within `reach` of the region's box, and four rings around it.
TriangleMesh CutOutSurroundings(double reach, const RegionParts& parts);

// The surface of the region alone, of the surroundings' (which has its curvature).
std::unique_ptr<MeshSurface> CutOutRegion(const RegionParts& parts);

// Which faces of the surroundings, as they were cut out, are not in the region: one flag each.
std::vector<bool> FacesBesideRegion(const TriangleMesh& around, const RegionParts& parts);

// Says in the parts what the faces and vertices of the surroundings are, `scale` times as large and with the region's slivers mended. Takes
// the origins of the faces.
void NameSurroundings(TriangleMesh& around, double scale, RegionParts& parts);

// Of the surroundings' attributes those of the region's faces.
MeshAttributes AttributesOfRegion(const RegionParts& parts, MeshAttributes around);

// The vertices of the whole on the region's border, in the order of its joints.
std::vector<uint32_t> BorderOf(const RegionParts& parts, const MeshSurface& region);

// How many times edges of the region's border that meet differ in length, at the most, and where; 1 where there is no border. Both stay, and
// triangles beside them are as narrow.
struct UnevenBorder {
  double ratio = 1;
  Vec3 place;
};
UnevenBorder MostUnevenBorder(const RegionParts& parts);

// Counts what repair changed of the input outside of the region, and with patch_only lists what is gone with it.
void CompareWithInput(RegionParts& parts);

// Adds the faces around the region that lie within the box of `mesh`, which takes the region's place, in its scale.
void AddFacesAround(const RegionParts& parts, TriangleMesh& mesh);

}  // namespace meshfront
