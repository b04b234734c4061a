// Repair of point sets: what is no sample of a surface is dropped, and normals that are missing are estimated.
#pragma once

#include <cstdint>
#include <vector>

#include "absl/status/statusor.h"
#include "core/base/context.h"
#include "core/mesh/given_normals.h"
#include "core/mesh/point_noise.h"
#include "core/mesh/repair.h"
#include "core/mesh/triangle_mesh.h"

namespace meshfront {

struct PointRepair {
  TriangleMesh points;  // in the order of the input, with unit normals
  // dropped_non_finite_points   a coordinate is not finite or beyond ±1e150
  // dropped_duplicate_points    at the place of an earlier one
  // dropped_outliers            far from all others, for how far those are from each other
  // estimated_normals           of the plane through the neighbours, turned to agree with them, or outward
  // replaced_normals            by those of the planes through the neighbours, on the side of those given, which disagree much more
  // turned_normals              to the side of most, where a part of the neighbours have them on opposite sides
  std::vector<RepairAction> actions;
  // Pairs of neighbours whose normals, as estimated, point apart: where it is not clear which side is which.
  uint64_t undecided_pairs = 0;
  PointNoise noise;          // of what is left
  NormalNoise normal_noise;  // of the normals that were given
};

// With `change` false nothing is dropped: FailedPrecondition where something would have to be, with its place. Normals
// are estimated in any case. InvalidArgument: fewer than 4 points are left. FailedPrecondition: those left lie on a line,
// or fill a volume as far as their neighbours tell. 3 µs a point, 10 where normals are missing.
// Deterministic.
absl::StatusOr<PointRepair> RepairPoints(TriangleMesh points, bool change, const Context& context);

// Normals of points that have none (zero): normal to the plane that fits so many neighbours, 14 at least, on the side of
// neighbours that have one, else outward, which is the side that encloses a volume. With `turn_given` those that have one
// are turned as well, in each part to the side of most.
struct SideReport {
  uint64_t undecided_pairs = 0;  // of neighbours, that remained on opposite sides
  uint64_t turned = 0;           // of the normals that were given
};
absl::StatusOr<SideReport> EstimateNormals(TriangleMesh& points, size_t plane_neighbours, bool turn_given,
                                           const Context& context);

}  // namespace meshfront
