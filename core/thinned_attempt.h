// An attempt of the front brought to a number of triangles that no front makes.
#pragma once

#include <cstdint>
#include <vector>

#include "absl/status/status.h"
#include "core/attempts.h"
#include "core/base/context.h"
#include "core/front/advancing_front.h"
#include "core/mesh/holding_sink.h"
#include "core/mesh/quality.h"
#include "core/mesh/topology.h"
#include "core/mesh/triangle_mesh.h"

namespace meshfront {

// The vertices and triangles of an output.
TriangleMesh MeshOf(const std::vector<HeldPiece>& pieces);
// What the report of a front says of its output, of one that took its place. `by_kind`: triangles, as in TriangleKind.
void Describe(const TopologyReport& topology, const QualityReport& quality, const uint64_t (&by_kind)[3],
              FrontReport& front);

// By how much of what is wanted the number of triangles is off; 0 where none is wanted.
double CountErrorOf(const Attempt& attempt, uint64_t wanted);
// More than that, by more than kCountPromise.
bool HasTooMany(const Attempt& attempt, uint64_t wanted);

// Takes triangles of an attempt out again (thinning.h) until so many are left, or none can go. Its pieces, which have wedges where there
// are creases, become one. Not where it has faults. The errors of ThinOut.
absl::Status ThinToCount(uint64_t wanted, Attempt& attempt, const Context& context);

}  // namespace meshfront
