// Welding of corners that lie at bit-equal positions, for formats that store triangles one by one.
#pragma once

#include <cstdint>
#include <vector>

#include "core/mesh/triangle_mesh.h"

namespace meshfront {

// Gives equal points equal ids, in the order of their first appearance. 0 and -0 are equal, and so is any NaN to one with its
// bits. Amortised O(1) a point; the hash is seeded per process, so that no file can be made to collide, and the ids do not depend
// on it.
class Welder {
 public:
  // Appends to `positions`, which must outlive the welder and be changed by nobody else.
  explicit Welder(std::vector<Vec3>& positions) : positions_(positions) {}
  VertexId Add(const Vec3& point);

 private:
  void Grow();

  std::vector<Vec3>& positions_;
  std::vector<uint32_t> slots_;  // open addressing, a power of two, at most two thirds full; Id::kInvalid is empty
};

}  // namespace meshfront
