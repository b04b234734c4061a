// Polylines that a caller wants to keep: faces are split along them, so that they are edges, and creases.
#pragma once

#include <cstdint>
#include <vector>

#include "absl/status/statusor.h"
#include "core/base/context.h"
#include "core/mesh/adjacency.h"
#include "core/mesh/polylines.h"
#include "core/mesh/triangle_mesh.h"

namespace meshfront {

struct InsertedLines {
  uint64_t moved_points = 0;  // farther from the surface than 1e-6 of the diagonal
  uint64_t split_faces = 0;   // triangles that there are more than before
};

// What limits them, where the mesh is a part of another one.
struct LineLimits {
  double diagonal = 0;            // that tolerances are parts of; 0: the mesh's
  std::vector<bool> fixed;        // of each face, whether it stays as it is with its sides; empty: none does
  std::vector<uint32_t> origins;  // what segments are called in messages; empty: by their numbers
};

// Brings the points of all segments to the nearest place of the surface and follows the segments over it, each in the plane through its
// ends and the normals there. Every point is a vertex then, at its place to 5e-7 of the diagonal; every segment is a chain of edges, whose
// flags are set in `creases` (one per half-edge) on both halves. Vertices within 1e-4 of the diagonal of a segment are taken for places
// on it. Splitting moves nothing: each new triangle lies in an old one, with the flags of its sides, its group, origin and attributes.
// InvalidArgument, with the segment: it is farther from the surface than 1 % of the diagonal, or can't be followed over it, as at a rim or over
// a fixed face.
// Stops with the context. About 1 µs a face that is crossed, and the time of a tree of all faces.
absl::StatusOr<InsertedLines> InsertPolylines(const Polylines& lines, TriangleMesh& mesh, FaceAdjacency& adjacency,
                                              std::vector<bool>& creases, const Context& context,
                                              const LineLimits& limits = {});

}  // namespace meshfront
