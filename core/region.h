// A part of a mesh that is remeshed alone (sec. 4.1): the faces with all three vertices in it. The rest comes back as it was, as do faces
// around which no mesh comes out right: those are no part of the region then, and a warning counts them.
#pragma once

#include <cstdint>
#include <variant>
#include <vector>

#include "absl/status/status.h"
#include "core/geometry/box.h"
#include "core/geometry/vec3.h"

namespace meshfront {

struct RegionSphere {
  Vec3 center;
  double radius = 0;  // > 0
};

// Faces by their numbers in the input as it was read, before any repair.
using RegionFaces = std::vector<uint32_t>;

struct Region {
  std::variant<RegionSphere, Box3, RegionFaces> shape;
  // Hand on the new triangles alone; Report.region lists what they replace. false: the whole mesh, the rest of the input first.
  bool patch_only = false;
};

// InvalidArgument naming the field, the value and the rule, for what is wrong with any mesh.
absl::Status ValidateRegion(const Region& region);

// What became of the input where a part of it was remeshed.
struct RegionReport {
  uint64_t kept_triangles = 0;      // of the input, not touched
  uint64_t replaced_triangles = 0;  // of the input, gone
  uint64_t new_triangles = 0;
  // With patch_only: the faces of the input that the patch takes the place of, in increasing order, and those that repair dropped.
  std::vector<uint32_t> removed_faces;
};

}  // namespace meshfront
