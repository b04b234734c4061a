// A patch that closes a hole in a surface: triangulated, refined and faired.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "absl/types/span.h"
#include "core/base/ids.h"
#include "core/geometry/vec3.h"
#include "core/mesh/triangle_mesh.h"

namespace meshfront {

// A vertex of a hole's rim, and the surface beside it.
struct HoleRimVertex {
  Vec3 position;
  Vec3 normal;  // unit length
  Vec3 behind;  // a place of the surface about an edge away from the rim
};

struct HolePatch {
  std::vector<Vec3> positions;  // the rim's first
  std::vector<Triangle> triangles;
  std::vector<std::array<VertexId, 2>>
      parents;  // of each vertex behind those of the rim: the ends of the edge that it was put on
};

// Goes on as the surface does beyond the rim (thin plate), or only spans it (membrane).
enum class PatchShape { kFair, kTaut };

// `rim`: a simple loop, the hole on its left. Edges of the patch are about as long as the rim's near by and somewhat longer farther in.
// Pairs of `joined` rim vertices are joined by an edge of the surface, and get no other. Nothing where there is no triangulation, or where
// the patch intersects itself. O(n³) for rims of up to 160 vertices, longer ones are cut down to that by ears first.
std::optional<HolePatch> MakeHolePatch(absl::Span<const HoleRimVertex> rim,
                                       absl::Span<const std::array<uint32_t, 2>> joined, PatchShape shape);

// Whether two points of a loop are farther apart than `size`. O(n) but for loops whose extent is about that.
bool IsWiderThan(absl::Span<const Vec3> loop, double size);

}  // namespace meshfront
