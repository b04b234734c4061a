// A point set as a mesh, where its surface is to have lines in it: edges that run along sharp edges, or along what a caller wants.
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

// A point set after repair.
struct SharpPoints {
  const TriangleMesh& points;  // with unit normals
  bool are_estimated = false;  // these are of planes through neighbours
  bool needs_mesh = false;     // also where it has no sharp edges: one with round edges, and no curves, then
};

// Nothing where it has no edge that turns by more than options.crease_angle (none: no edge is sharp) and stands clear of the noise, and
// needs no mesh; or, with a warning, where the surface with round edges that it begins with can't be meshed, which is FailedPrecondition
// where it needs one. Memory and time as for 2 to 4 triangles a point. Errors of Remesh.
absl::StatusOr<std::optional<SharpMesh>> MeshSharpPoints(const SharpPoints& input, const RemeshOptions& options,
                                                         std::vector<std::string>& warnings, const Context& context);

}  // namespace meshfront
