// Wavefront OBJ: the polygons, nothing else.
#pragma once

#include "core/io/output.h"
#include "core/io/source.h"

namespace meshfront {

// Faces with v, v/vt, v//vn and v/vt/vn corners, counted from 1 or backwards from the last vertex; line continuations; vertex
// colours after the coordinates. Without faces it is a point set, with its vn when there is one per vertex. Lines, materials and
// groups are left out; material libraries are never opened. A line whose first word is not a word is refused.
absl::StatusOr<ReadResult> ReadObj(const Source& source);
absl::Status WriteObj(const TriangleMesh& mesh, Output& output);

}  // namespace meshfront
