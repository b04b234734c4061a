// Unit normals of a mesh's vertices, and what of its area is theirs.
#pragma once

#include <vector>

#include "core/mesh/triangle_mesh.h"

namespace meshfront {

// The face normals around each vertex, weighted by the angles there (to 7e-5 rad, in plain arithmetic: library functions differ
// between processors). A vertex whose faces cancel out takes the normal of its largest face, one without any area (0, 0, 1).
// O(n), about 20 ns a face.
std::vector<Vec3> ComputeVertexNormals(const TriangleMesh& mesh);

// A third of the area of the faces around each vertex. O(n).
std::vector<double> ComputeVertexAreas(const TriangleMesh& mesh);

// The angle between two vectors in radians from its cosine, within 7e-5 (Abramowitz and Stegun 4.4.45).
double ApproximateAngle(double cosine);

}  // namespace meshfront
