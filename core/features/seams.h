// Where sheets that repair parted, or that a file keeps apart, still touch along an edge.
#pragma once

#include <vector>

#include "core/mesh/adjacency.h"
#include "core/mesh/triangle_mesh.h"

namespace meshfront {

// Sets the flags of both halves of each inner edge that joins the same two places as another edge of the mesh: as creases both are
// divided, and alike (BoundaryLoops), so that the sheets touch in the output as they do here. Edges over which they would be divided
// apart pass through each other. `creases`: one flag per half-edge. O(vertices).
void MarkSeams(const TriangleMesh& mesh, const FaceAdjacency& adjacency, std::vector<bool>& creases);

}  // namespace meshfront
