// Point lists: "x y z" or "x y z nx ny nz" a line, and PTS.
#pragma once

#include "core/io/output.h"
#include "core/io/source.h"

namespace meshfront {

// Lines of 3 numbers (a point), 4 (and an intensity), 6 (and a normal, or a colour where most lengths are far from 1) or
// 7 (intensity and colour); all lines alike. A first line of one integer is the number of points (PTS) and must be true.
// Comments begin with # or //.
absl::StatusOr<ReadResult> ReadXyz(const Source& source);
// Points and their normals. InvalidArgument for a mesh with triangles, which the format has no place for.
absl::Status WriteXyz(const TriangleMesh& mesh, Output& output);

}  // namespace meshfront
