// Where no front comes out right the surface is cut again: along its creases where those were not to be kept, or into its own faces, which
// meet no other than the input's do.
#pragma once

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/types/span.h"
#include "core/base/context.h"
#include "core/preparation.h"

namespace meshfront {

// Cuts the surface along all three sides of each face that has a place within `reach` times g of one of `places`: each becomes a patch
// of its own, flat, whose mesh is that face or parts of it. Surface, curvatures and seeds of the preparation are replaced; its field and
// loops are out of date until PrepareAgain. Cancelled or DeadlineExceeded. As long as making the surface and its curvatures, and as much
// memory again as the surface until it returns.
absl::Status CutFacesLoose(absl::Span<const Vec3> places, double reach, Preparation& preparation,
                           const Context& context);

// Cuts a surface that was not cut along creases along those that turn by more than `angle` (radians). False: there are none, and nothing
// has changed. Else as CutFacesLoose.
absl::StatusOr<bool> CutAlongCreases(double angle, Preparation& preparation, const Context& context);

}  // namespace meshfront
