// Vertices that a broken number has thrown far away from everything else.
#pragma once

#include <cstdint>

#include "core/mesh/repair_survey.h"
#include "core/mesh/triangle_mesh.h"

namespace meshfront {

// Whether a longest side this much above the median makes it worth looking.
bool MayHaveSpikes(const MeshSurvey& survey);

// Moves every vertex that is farther from its neighbours than kSpikeRatio times their own spread, and than that many
// times the median distance of all vertices from their middle, to the middle of its neighbours. Returns how many.
uint64_t MoveSpikes(TriangleMesh& mesh);

}  // namespace meshfront
