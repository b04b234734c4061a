// A point set with sharp edges as a mesh whose edges run along them.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/remesh.h"

namespace meshfront {

struct SharpMesh {
  TriangleMesh mesh;  // as fine as the samples
  uint64_t curves = 0, corners = 0;
  uint64_t blunt_places = 0;  // where pieces meet, but no place was found that lies on all of them
};

// Of a point set after repair, with unit normals. Nothing where it has no edge that turns by more than options.crease_angle (which must be
// set) and stands clear of the noise; or, with a warning, where the surface with round edges that it begins with can't be meshed. With
// `are_estimated` the normals are those of planes through neighbours. Memory and time as for 2 to 4 triangles a point. Errors of Remesh.
absl::StatusOr<std::optional<SharpMesh>> MeshSharpPoints(const TriangleMesh& points, const RemeshOptions& options,
                                                         bool are_estimated, std::vector<std::string>& warnings,
                                                         const Context& context);

}  // namespace meshfront
