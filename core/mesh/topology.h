// Counts of a mesh: components, boundary loops, genus, manifoldness.
#pragma once

#include <cstdint>
#include <optional>

#include "core/mesh/adjacency.h"
#include "core/mesh/triangle_mesh.h"

namespace meshfront {

struct TopologyReport {
  uint64_t vertices = 0;    // used by a triangle
  uint64_t triangles = 0;   // with three different, finite corners; the others are left out of every count
  uint64_t components = 0;  // connected by vertices
  uint64_t boundary_edges = 0;
  uint64_t boundary_loops = 0;
  // Summed over components, (2 − χ − loops) / 2 each; unset unless manifold and orientable.
  std::optional<int64_t> genus;
  int64_t euler_characteristic = 0;
  bool closed = false;    // has triangles and no boundary edge
  bool manifold = false;  // no edge with more than two faces, no vertex whose faces are not one fan
  bool oriented = false;  // no edge that two faces run through in the same direction
};

// O(n); never fails, whatever the mesh is. Loops are followed around each vertex inside its fan, as they run once
// pinched vertices are split.
TopologyReport MeasureTopology(const TriangleMesh& mesh);
// The same of what RepairMesh returned, with its adjacency; half the time. And where it is known how many components there are.
TopologyReport MeasureTopology(const TriangleMesh& mesh, const FaceAdjacency& adjacency);
TopologyReport MeasureTopology(const TriangleMesh& mesh, const FaceAdjacency& adjacency, uint64_t components);

}  // namespace meshfront
