// Where the attributes of a mesh break: seams of texture coordinates, hard normals, borders of colours and of materials.
#pragma once

#include <vector>

#include "core/mesh/adjacency.h"
#include "core/mesh/triangle_mesh.h"

namespace meshfront {

// Sets the flags of both halves of each inner edge on whose sides the attributes differ, so that the surface is cut along it as along
// a crease, and no triangle of the output spans it:
//   groups     that differ
//   values     of texture coordinates, colours or custom attributes that differ at both ends, by more than 1e-4 of the attribute's range
//              (colours: half a step of 8 bits); at one end only where a seam ends, not where many meet, as at the pole of a globe
//   mirrors    where texture coordinates are unfolded to the other side
//   normals    that differ by more than 5° at both ends, where the faces do too
// Normals break at more than a fifth of the edges where they are those of flat faces: then they make no seam, and true is returned.
// Skin weights and tangents make none. `creases`: one flag per half-edge. O(faces).
bool MarkAttributeSeams(const TriangleMesh& mesh, const FaceAdjacency& adjacency, std::vector<bool>& creases);

}  // namespace meshfront
