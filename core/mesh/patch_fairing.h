// Where the inner vertices of a patch lie, by its edges and what surrounds it.
#pragma once

#include "absl/types/span.h"
#include "core/mesh/hole_patch.h"
#include "core/mesh/triangle_mesh.h"

namespace meshfront {

// Moves the vertices of `patch` behind the first rim.size(). kFair: the sum of squared bends is the least, those along the rim included,
// where the surface behind it counts; kTaut: each vertex lies in the middle of its neighbours. `lengths`: how long edges should be around
// each vertex. False where there is no solution; nothing is moved then. About 10 µs a vertex.
bool FairPatch(absl::Span<const HoleRimVertex> rim, absl::Span<const double> lengths, PatchShape shape,
               TriangleMesh& patch);

}  // namespace meshfront
