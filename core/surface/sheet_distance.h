// How near another sheet of the surface comes: the other side of a thin plate, another limb.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/types/span.h"
#include "core/base/context.h"
#include "core/mesh/adjacency.h"
#include "core/mesh/triangle_mesh.h"

namespace meshfront {

// How a mesh that was cut along creases hangs together: the half-edge across each side before the cut, and the vertex that each is
// a copy of. Both empty where nothing was cut.
struct UncutMesh {
  absl::Span<const std::array<uint32_t, 3>> opposite;
  absl::Span<const uint32_t> originals;
};

// For each vertex, the length of the shorter of the two rays along ± its normal to a face that looks the other way (cosine below
// kOpposed) and is not near along the surface (kOtherSheetDetour; creases are no obstacle), at most `limits[v]`; +infinity when
// there is none. Where vertices are dense against the limits only some are probed, the others take the least of their neighbours.
// On the context's threads; deterministic. 0.2 to 1 µs a vertex, plus a hierarchy over the faces.
absl::StatusOr<std::vector<double>> MeasureSheetDistances(const TriangleMesh& mesh, const FaceAdjacency& adjacency,
                                                          absl::Span<const Vec3> normals,
                                                          absl::Span<const double> limits, const Context& context,
                                                          const UncutMesh& uncut = {});

}  // namespace meshfront
