// Everything before the front for a point set: from the points as read to a surface, a guidance field and the fronts to
// start from.
#pragma once

#include "absl/status/statusor.h"
#include "core/preparation.h"

namespace meshfront {

// Whether the problem's input is to be meshed as a point set.
bool IsMeshedAsPoints(const Problem& problem);

// The stages up to the first triangle, as Prepare.
absl::StatusOr<Preparation> PreparePoints(Problem problem, const Context& context);

// The fronts to start from: the rims, and a seed in each part without one.
void SetPointFronts(Preparation& p);

}  // namespace meshfront
