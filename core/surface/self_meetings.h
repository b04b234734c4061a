// Where a mesh passes through itself or touches itself, to be asked by place.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "absl/types/span.h"
#include "core/base/context.h"
#include "core/geometry/bvh.h"
#include "core/mesh/triangle_mesh.h"

namespace meshfront {

// Immutable; safe to read from many threads. Memory: about 250 bytes for each pair of faces that meet.
class SelfMeetings {
 public:
  // Vertices at equal positions are one: fans that were parted touch there as they did before. `rims`: the ends of the mesh's boundary
  // edges; where two of them coincide sheets were parted along a seam, which is a place where they meet. As long as
  // FindSelfIntersections, on the context's threads.
  SelfMeetings(const TriangleMesh& mesh, absl::Span<const std::array<Vec3, 2>> rims, const Context& context);

  // Whether two faces meet within `radius` of a place. O(log of their number) where they are few. Yes everywhere when the context stopped
  // the search, or more than 200,000 pairs meet: a mesh that is more knot than surface.
  bool IsAnyWithin(const Vec3& place, double radius) const;
  // The same without seams: there each face ends, and none passes through another.
  bool DoFacesMeetWithin(const Vec3& place, double radius) const;

 private:
  void AddMeetings(const TriangleMesh& mesh, const Context& context);
  void AddSeams(absl::Span<const std::array<Vec3, 2>> rims);
  bool IsAnyWithin(const Vec3& place, double radius, bool counts_seams) const;
  struct Meeting {
    std::array<Vec3, 3> a, b;
    std::optional<std::array<Vec3, 2>> stretch;  // none: they only touch, or lie in one plane
    bool is_seam = false;
  };
  bool is_complete_ = false;
  std::vector<Meeting> meetings_;
  // Over the stretches, or the faces where there is none; null where nothing meets. The arrays are the tree's.
  std::vector<Vec3> positions_;
  std::vector<TriangleBvh::Corners> triangles_;
  std::unique_ptr<TriangleBvh> tree_;
};

}  // namespace meshfront
