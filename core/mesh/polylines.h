// Lines in space, as a caller draws them.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "absl/status/status.h"
#include "core/geometry/vec3.h"

namespace meshfront {

// Segments between points; those that share a point are one line there.
struct Polylines {
  std::vector<Vec3> points;
  std::vector<std::array<uint32_t, 2>> segments;
};
// InvalidArgument: a point that is not finite, a segment that names no point.
absl::Status ValidatePolylines(const Polylines& lines);

}  // namespace meshfront
