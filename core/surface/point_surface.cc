#include "core/surface/point_surface.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "core/surface/tolerances.h"

namespace meshfront {
namespace {

using namespace surface_tolerances;

}  // namespace

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

bool PointSurface::FindFarPlaces(const SourcePoint& start, const std::array<Vec3, 3>& triangle, double bound,
                                 double beside, std::vector<FarPlace>& far, std::vector<DoubtfulPart>* doubtful) const {
  static_cast<void>(beside);
  far.clear();
  if (doubtful) doubtful->clear();
  SourcePoint at = start;
  for (int i = 0; i <= kFarLattice; ++i) {
    for (int j = 0; i + j <= kFarLattice; ++j) {
      const int k = kFarLattice - i - j;
      if (std::max({i, j, k}) == kFarLattice) continue;  // a corner
      const Vec3 x = (i * triangle[0] + j * triangle[1] + k * triangle[2]) / kFarLattice;
      at.patch = samples().PatchNear(x, start.normal, at.patch);
      const MlsValue<1> value = ValueAt(x, at.patch);
      if (std::abs(value.f.value()) <= bound * Norm(value.f.Gradient())) continue;
      FarPlace place{x, FootOf(at, x)};
      if (Distance(place.above.position, x) > bound) far.push_back(place);
    }
  }
  return true;
}

}  // namespace meshfront
