// How often a mesh or soup winds around a place: 1 inside of a closed part that faces outward, 0 outside, 2 where two parts
// overlap, and something between beside open ones.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "core/geometry/point_tree.h"
#include "core/mesh/triangle_mesh.h"

namespace meshfront {

// Immutable, safe to read from many threads, deterministic. O(n log n); 130 bytes a face.
class WindingNumber {
 public:
  explicit WindingNumber(const TriangleMesh& mesh);  // which outlives it
  // The sum of solid angles over 4π: exact for faces near by, far ones taken together (within about 0.05). 5 µs.
  double At(const Vec3& x) const;

 private:
  // The faces of a node seen from far: their area vectors' sum, and a ball that holds them.
  struct Cluster {
    Vec3 area, center;
    double radius = 0;
  };
  const TriangleMesh& mesh_;
  std::vector<Vec3> centroids_;
  std::unique_ptr<PointTree> tree_;
  std::vector<Cluster> clusters_;  // of the tree's nodes
};

}  // namespace meshfront
