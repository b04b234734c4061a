// The mesh that the quickstart remeshes when it is given none.
#pragma once

#include "core/mesh/triangle_mesh.h"

namespace meshfront {

// An iso-surface as a scanner or a volume pipeline would give it: a body, a thick ring, thin rods and a wire loop, smoothly
// joined, cut out of a grid by marching tetrahedra. Closed and manifold, one component, outward, about 30,000 triangles, a good part
// of them slivers. The same bits on every call.
TriangleMesh SampleMesh();

}  // namespace meshfront
