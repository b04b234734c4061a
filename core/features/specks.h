// Which creases are noise: those of a few small patches that lie inside a large one and zigzag.
#pragma once

#include <cstdint>
#include <vector>

#include "core/mesh/adjacency.h"
#include "core/mesh/triangle_mesh.h"

namespace meshfront {

// One flag per half-edge: the creases on and inside specks of at most `most_faces` faces, both halves of each. Patches are faces
// that hang together without crossing a crease; patches of at most so many faces that touch are taken together. What makes them a
// speck, as numbers: the last part of core/features/tolerances.h. `creases`: one flag per half-edge, alike on both halves.
// O(faces), two labelings.
std::vector<bool> FindSpecks(const TriangleMesh& mesh, const FaceAdjacency& adjacency, const std::vector<bool>& creases,
                             uint32_t most_faces);

}  // namespace meshfront
