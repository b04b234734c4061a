// The rims of a point set's surface as initial fronts: resampled by the guidance field, as those of meshes are
// (boundary.h).
#pragma once

#include <vector>

#include "absl/types/span.h"
#include "core/guidance/guidance_field.h"
#include "core/surface/mls_rims.h"
#include "core/surface/oriented_loop.h"

namespace meshfront {

// Edges of about g, at least three a loop; every point lies on the rim.
std::vector<OrientedLoop> RimLoops(const PointSurface& surface, absl::Span<const RimCurve> curves,
                                   const GuidanceField& field);

}  // namespace meshfront
