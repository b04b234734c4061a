// Fewer triangles of a mesh that is right already: vertices go, one by one, and nothing that was right becomes wrong.
#pragma once

#include <cstdint>

#include "absl/status/statusor.h"
#include "core/base/context.h"
#include "core/mesh/holding_sink.h"

namespace meshfront {

// Takes vertices out of a mesh until it has at most `most_triangles`, or none can go: a vertex is drawn onto a neighbour, and the
// triangles between the two vanish. Vertices keep their places, normals and wedges, so that what is left lies on the surface. Which goes
// first is told by quadrics of the triangles and of the feature edges, by the length of the way and by the shape of what it leaves.
//
// `mesh`: one piece that is a whole, oriented manifold, perhaps with boundary. Feature edges are its rims and, where it has corners'
// wedges, those on whose sides a wedge differs: vertices on them go along them only, and not where other than two meet. So topology,
// rims and features stay, up to their shape. No triangle is made that meets another one where it did not before, turns by more than 90°,
// or is folded back upon its neighbour, unless one around it was.
//
// Returns how many triangles are left. The piece is numbered anew, without what is used no more. Deterministic; O(n log n). Cancelled or
// DeadlineExceeded; the mesh is then unspecified.
absl::StatusOr<uint64_t> ThinOut(uint64_t most_triangles, HeldPiece& mesh, const Context& context);

}  // namespace meshfront
