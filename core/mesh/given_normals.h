// Whether the normals that come with points are worth more than what the points themselves tell.
#pragma once

#include <cstddef>

#include "absl/status/status.h"
#include "core/base/context.h"
#include "core/geometry/point_tree.h"
#include "core/mesh/triangle_mesh.h"

namespace meshfront {

// Of up to 1,024 of the points, degrees.
struct NormalNoise {
  double from_planes = 0;     // between normals and the planes through their neighbours, the median
  double between_given = 0;   // between the normals of nearest neighbours, as lines, the median
  double between_planes = 0;  // between the planes through their neighbours, the median
  // Normals that disagree with the planes, and more with each other than planes do. Where the points are few for their shape, planes
  // disagree as much.
  bool AreWorseThanPlanes() const;
};

// `tree` is that of the points' positions; `plane_neighbours` > 2 lie around each plane. A point without a normal is passed over.
// Deterministic. 10 µs for each point asked.
NormalNoise MeasureNormalNoise(const TriangleMesh& points, const PointTree& tree, size_t plane_neighbours);

// Makes each normal that of the plane through its point's neighbours, on the side of the one that was given. Those that are missing
// stay so. 5 µs a point and core; Cancelled or DeadlineExceeded.
absl::Status ReplaceByPlaneNormals(TriangleMesh& points, const PointTree& tree, size_t plane_neighbours,
                                   const Context& context);

}  // namespace meshfront
