// Shapes whose coordinates were rounded as those of files are.
#pragma once

#include "core/mesh/triangle_mesh.h"

namespace meshfront::testing {

// The coordinates as a text with such numbers ("%.6g") gives them back.
TriangleMesh AsWritten(TriangleMesh mesh, const char* format);
// … and as floats.
TriangleMesh AsFloats(TriangleMesh mesh);

}  // namespace meshfront::testing
