// Which triangles come so near each other that they may intersect? A broad phase for the audit.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "absl/types/span.h"
#include "core/geometry/vec3.h"
#include "core/mesh/triangle_mesh.h"

namespace meshfront {

struct MeetingBoxes {
  std::vector<std::pair<uint32_t, uint32_t>> pairs;  // of triangles, each pair once
  std::vector<uint32_t> order;                       // of the triangles, by place: the same for the same places
};

// Pairs of triangles whose bounding boxes meet (and perhaps some that are apart by a rounding of floats), one of them wanted
// (`is_wanted`, a flag for each triangle), that share no vertex which keeps them apart (`keeps_apart`, a flag for each vertex).
// Coordinates finite and below 1e150. O(n) for surfaces, about 0.5 µs a triangle.
MeetingBoxes FindMeetingBoxes(absl::Span<const Vec3> positions, absl::Span<const Triangle> triangles,
                              absl::Span<const uint8_t> is_wanted, absl::Span<const uint8_t> keeps_apart);

}  // namespace meshfront
