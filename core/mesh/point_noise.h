// How far the points of a set lie off the surface that they sample, from themselves alone.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/types/span.h"
#include "core/base/context.h"
#include "core/geometry/point_tree.h"
#include "core/geometry/vec3.h"

namespace meshfront {

struct PointNoise {
  double spacing = 0;    // between neighbours on the surface, the median
  double deviation = 0;  // from the plane through the neighbours, the root of the mean square, the median
  double flatness = 0;   // what neighbours measure across their plane in parts of along it, the median; of a ball 0.8
  // So many are needed until what lies around a point looks flat; the fewest where there is no noise.
  size_t neighbours = 0;
};

// The plane through the nearest points around one, and their root mean squares across it and along its axes.
struct NeighbourPlane {
  Vec3 normal;
  double across = 0, along = 0, longest = 0;
};
NeighbourPlane FitNeighbourPlane(absl::Span<const Vec3> positions, absl::Span<const uint32_t> neighbours);

// Of at least 4 points, from up to 1,024 of them. Edges and thin sheets are no noise, as long as most points do not lie at
// one. Deterministic. Half a millisecond for each.
PointNoise MeasurePointNoise(absl::Span<const Vec3> positions);
PointNoise MeasurePointNoise(absl::Span<const Vec3> positions, const PointTree& tree);  // the tree of these positions

}  // namespace meshfront
