// Which faces of a mesh a region is.
#pragma once

#include <cstdint>
#include <vector>

#include "absl/status/statusor.h"
#include "core/mesh/triangle_mesh.h"
#include "core/region.h"

namespace meshfront {

// The faces of `mesh` in the region, in increasing order, at least one. Faces given by number are those with these origins (all of them
// must be below `input_faces`; those that a repair dropped are not looked for). InvalidArgument: a number out of range, or no face is in
// the region.
absl::StatusOr<std::vector<uint32_t>> SelectFaces(const TriangleMesh& mesh, const Region& region, uint64_t input_faces);

}  // namespace meshfront
