// How far two meshes are from each other, both ways, by dense sampling.
#pragma once

#include <cstdint>

#include "absl/status/statusor.h"
#include "core/base/context.h"
#include "core/mesh/triangle_mesh.h"

namespace meshfront {

struct DistanceOptions {
  // Each way, besides every vertex: a tenth on edges by length, the rest on faces by area; at least 10.
  uint64_t samples = 200'000;
  uint64_t seed = 1;
};

// From the samples of one mesh to the other mesh.
struct DirectedDistance {
  double max = 0;   // over all samples: a lower bound of the true maximum
  Vec3 max_at;      // the sample it was found at
  double mean = 0;  // over face samples, hence averages by area
  double rms = 0;
  uint64_t samples = 0;
};

struct DistanceReport {
  DirectedDistance forward;   // mesh -> reference
  DirectedDistance backward;  // reference -> mesh
  double reference_diagonal = 0;
  double SymmetricMax() const { return forward.max > backward.max ? forward.max : backward.max; }
  // In percent of the reference's bounding box diagonal.
  double Percent(double distance) const { return reference_diagonal > 0 ? 100 * distance / reference_diagonal : 0; }
};

// Triangles with a repeated index or a corner that is not finite take no part. InvalidArgument when either mesh has no
// other, or an index is out of range; Cancelled or DeadlineExceeded. The same result at any number of threads. About 2
// µs a sample near the surface.
absl::StatusOr<DistanceReport> MeasureDistance(const TriangleMesh& mesh, const TriangleMesh& reference,
                                               const DistanceOptions& options, const Context& context);

}  // namespace meshfront
