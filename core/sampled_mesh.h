// A mesh or triangle soup as a point set.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/remesh.h"

namespace meshfront {

struct SampledMesh {
  TriangleMesh points;  // with normals
  InputReport input;    // of the mesh after repair, with a row for the sampling
  std::vector<std::string> warnings;
};

// Repairs the mesh and samples it a few times for each edge that the options would make on it, 20,000 to 200,000 times in
// all: faces that overlap, cracks and holes narrower than the samples' supports are nothing to a surface of points. Samples
// inside of other parts are left out (WindingNumber), so that parts that overlap become one. Attributes are dropped. The errors of Prepare.
absl::StatusOr<SampledMesh> SampleAsPoints(Problem problem, const Context& context);

}  // namespace meshfront
