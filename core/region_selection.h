// Which faces of a mesh a region is.
#pragma once

#include <vector>

#include "absl/status/statusor.h"
#include "core/mesh/triangle_mesh.h"
#include "core/region.h"

namespace meshfront {

// One flag a face of `mesh`, at least one of which is set. Faces given by number are those with these origins (all of them must be below
// `input_faces`; those that a repair dropped are not looked for). InvalidArgument: a number out of range, or no face is in the region.
absl::StatusOr<std::vector<bool>> SelectFaces(const TriangleMesh& mesh, const Region& region, uint64_t input_faces);

}  // namespace meshfront
