// PLY: ascii, binary little-endian, binary big-endian.
#pragma once

#include "core/io/output.h"
#include "core/io/source.h"

namespace meshfront {

// Whether the first line is "ply".
bool IsPly(const Source& source);
// Elements in any order and number; of `vertex` x, y, z (and nx, ny, nz of a point set) in any type, of `face` the list
// vertex_indices or vertex_index, of `tristrips` the list vertex_indices, where -1 begins a new strip. Everything else is
// passed over and listed in dropped_attributes. Without faces and strips it is a point set.
absl::StatusOr<ReadResult> ReadPly(const Source& source);
// Binary little-endian with coordinates as doubles: exact for every mesh, at 12 bytes a vertex more than floats.
absl::Status WritePly(const TriangleMesh& mesh, Output& output);

}  // namespace meshfront
