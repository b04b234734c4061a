// Where a mesh passes through itself or touches itself, to be asked by place.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "core/geometry/bvh.h"
#include "core/mesh/triangle_mesh.h"

namespace meshfront {

// Immutable; safe to read from many threads. Memory: about 250 bytes for each pair of faces that meet.
class SelfMeetings {
 public:
  // Vertices at equal positions are one: fans that were parted touch there as they did before. As long as FindSelfIntersections.
  explicit SelfMeetings(const TriangleMesh& mesh);

  // Whether two faces meet within `radius` of a place. O(log of their number) where they are few.
  bool IsAnyWithin(const Vec3& place, double radius) const;

 private:
  struct Meeting {
    std::array<Vec3, 3> a, b;
    std::optional<std::array<Vec3, 2>> stretch;  // none: they only touch, or lie in one plane
  };
  std::vector<Meeting> meetings_;
  // Over the stretches, or the faces where there is none; null where nothing meets. The arrays are the tree's.
  std::vector<Vec3> positions_;
  std::vector<TriangleBvh::Corners> triangles_;
  std::unique_ptr<TriangleBvh> tree_;
};

}  // namespace meshfront
