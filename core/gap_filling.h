// Samples that close the gaps of a point set: between its rims, where its surface would go on.
#pragma once

#include <cstdint>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/types/span.h"
#include "core/base/context.h"
#include "core/surface/mls_rims.h"
#include "core/surface/point_surface.h"

namespace meshfront {

struct GapSamples {
  std::vector<Vec3> positions, normals;
  std::vector<Vec3> places;     // one on the rim of each gap that they close
  std::vector<Vec3> left_open;  // … and of those that no patch closes without passing through samples
};

// Closes the rims whose diameter is at most `size` by patches as those of a mesh's holes (hole_filling.h), with samples about as far
// apart as those around, or somewhat farther inside of large gaps. About 30 µs a sample that is added.
absl::StatusOr<GapSamples> FillGaps(const PointSurface& surface, absl::Span<const RimCurve> rims, double size,
                                    const Context& context);

}  // namespace meshfront
