// The rung of the ladder that closes a loop at once (engine sec. 5).
#pragma once

#include <optional>
#include <vector>

#include "core/front/proposer.h"
#include "core/geometry/loop_triangulation.h"

namespace meshfront {

// The minimum-weight triangulation of a loop of front edges, with a penalty for folds, whose triangles agree with the surface's
// normals and stand for the surface as `strictness` asks. Positions of the steps are those of the edges' starts in `loop`. Nothing
// when there is none, when the loop has more than 64 edges, passes a vertex twice, or goes around the hole in a sheet.
std::optional<std::vector<ClosureStep>> ProposeClosure(const FrontSet& fronts, const Proposer& proposer,
                                                       const std::vector<FrontEdgeId>& loop,
                                                       const Strictness& strictness);

}  // namespace meshfront
