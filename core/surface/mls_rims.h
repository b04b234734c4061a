// Where the surface of a point set ends: curves along which the samples lie to one side.
#pragma once

#include <vector>

#include "absl/status/statusor.h"
#include "core/base/context.h"
#include "core/surface/point_surface.h"

namespace meshfront {

// A closed curve, last place joined to first, with the surface on its right as in OrientedLoop, in steps of a part of
// the support.
struct RimCurve {
  std::vector<SourcePoint> places;
  std::vector<double> curvatures;  // of the curve, over a support's width
  double length = 0;
  uint32_t component = 0;
};

struct RimCurves {
  std::vector<RimCurve> curves;
  uint64_t lost = 0;              // that could not be followed until they closed
  std::vector<Vec3> lost_places;  // along them
};

// All rims, by the first sample beside each. About 20 µs a step of the curves, and 1 µs a sample.
absl::StatusOr<RimCurves> TraceRims(const PointSurface& surface, const Context& context);

// The place of the surface's rim next to a place near it; nothing where it is not found.
std::optional<SourcePoint> FindRimPlace(const PointSurface& surface, const SourcePoint& near);

}  // namespace meshfront
