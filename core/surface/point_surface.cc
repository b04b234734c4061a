#include "core/surface/point_surface.h"

#include <cstdint>
#include <limits>

namespace meshfront {

std::vector<SourcePoint> PointSurface::Seeds() const {
  std::vector<double> least(samples().component_count(), std::numeric_limits<double>::infinity());
  std::vector<uint32_t> best(samples().component_count(), 0);
  for (uint32_t i = 0; i < samples().samples().size(); ++i) {
    const uint32_t component = samples().ComponentOf(i);
    if (component == MlsSamples::kStray) continue;
    // Cheap first: most samples are bent more than the best.
    const double bent = (i < curvatures().size() ? curvatures()[i] : 0) * samples().samples()[i].support;
    if (bent >= least[component]) continue;
    const double cost = bent + AsymmetryAt(i);
    if (cost < least[component]) least[component] = cost, best[component] = i;
  }
  std::vector<SourcePoint> seeds;
  for (const uint32_t i : best) seeds.push_back(AtSample(i));
  return seeds;
}

}  // namespace meshfront
