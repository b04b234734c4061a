// The heart of repair: which side of which triangle continues in which other, decided edge by edge, whatever the mesh
// is; then vertices made to fit. Vertices are what the pairing says: one for each fan of triangles that it connects.
#pragma once

#include <cstdint>
#include <vector>

#include "core/mesh/triangle_mesh.h"

namespace meshfront {

struct PairingChanges {
  uint64_t split_edges = 0;  // had more than two faces
  uint64_t reversed_faces = 0;
  uint64_t cut_edges = 0;        // of components that can't be oriented
  uint64_t welded_vertices = 0;  // gone into another at the same position
  uint64_t split_vertices = 0;   // new copies
  uint64_t dropped_faces = 0;    // that no copy of a vertex could make manifold
  bool any() const {
    return split_edges + reversed_faces + cut_edges + welded_vertices + split_vertices + dropped_faces > 0;
  }
};

// Makes an oriented manifold of the triangles, none of which may have a repeated index or a twin with the same
// vertices. Geometry does not change, but for dropped faces. An oriented manifold without rims to join stays as it is,
// bit for bit. O(n log n).
PairingChanges MakeOrientedManifold(TriangleMesh& mesh);

// For the rims of an oriented manifold: whether two run in opposite directions between the same positions, so that
// MakeOrientedManifold may join them.
bool HasCoincidentRims(const TriangleMesh& mesh, const std::vector<uint32_t>& rim_half_edges);

}  // namespace meshfront
