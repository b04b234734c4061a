// Whether triangles and segments meet, exactly: touching counts, rounding does not.
#pragma once

#include <array>
#include <optional>

#include "core/base/ids.h"
#include "core/geometry/vec3.h"

namespace meshfront {

// Which corners two triangles have in common, by identity and not by position: in_b[i] is the corner of b that is
// corner i of a, or −1.
struct SharedCorners {
  std::array<int, 3> in_b = {-1, -1, -1};
  int count = 0;
};
SharedCorners SharedCornersOf(const std::array<VertexId, 3>& a, const std::array<VertexId, 3>& b);

// Whether two triangles have more in common than their shared corners and the edge between two of them: they cross,
// touch, overlap in their plane, or are the same. Triangles without area (their corners on one line, exactly) never
// intersect anything. Coordinates as for Orient3d. 5 ns when the boxes are apart, 20 ns when one lies on one side of
// the other's plane.
bool TrianglesIntersect(const Vec3 (&a)[3], const Vec3 (&b)[3], const SharedCorners& shared = {});

// Where two triangles that intersect do so, rounded: the ends of the stretch that they have in common. Nothing where they lie in one
// plane, or only touch.
std::optional<std::array<Vec3, 2>> CommonStretch(const Vec3 (&a)[3], const Vec3 (&b)[3]);
// A point to name the place by: the middle of that stretch, or the centroid of the first triangle where there is none.
Vec3 PlaceOfMeeting(const Vec3 (&a)[3], const Vec3 (&b)[3]);

// Whether the closed segment pq and the closed triangle have a point in common; a triangle without area has none.
bool SegmentMeetsTriangle(const Vec3& p, const Vec3& q, const Vec3 (&triangle)[3]);

}  // namespace meshfront
