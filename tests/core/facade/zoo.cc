#include "tests/core/facade/zoo.h"

#include <algorithm>

#include "tests/support/shapes.h"

namespace meshfront::testing {
namespace {

#ifdef MESHFRONT_COARSE_ZOO
constexpr bool kFine = false;
#else
constexpr bool kFine = true;
#endif

}  // namespace

const std::vector<ZooShape>& Zoo() {
  static const auto* const shapes = new std::vector<ZooShape>{
      {"Sphere", [] { return Icosphere(kFine ? 5 : 4); }, 1},
      {"Torus", [] { return Torus(1, 0.4, kFine ? 120 : 60, kFine ? 48 : 24); }, 2.5},
      {"SlenderTorus", [] { return Torus(1, 0.1, kFine ? 250 : 125, kFine ? 32 : 16); }, 10},
      {"GenusThree", [] { return GenusThree(kFine ? 96 : 64); }, 8},
      {"DiskWithHoles", [] { return DiskWithHoles(kFine ? 60 : 40, 3); }, 0.5},
      {"Hemisphere", [] { return Hemisphere(kFine ? 5 : 4); }, 1},
      {"OpenCylinder", [] { return OpenCylinder(1, 3, kFine ? 80 : 48, kFine ? 40 : 24); }, 1},
      {"WavyTerrain", [] { return WavyTerrain(kFine ? 80 : 48); }, 6},
      {"FlatSheet", [] { return Sheet(20); }, 0},
      {"TwoSpheres", [] { return TwoSpheres(kFine ? 4 : 3); }, 1},
      {"ConcentricShells", [] { return ConcentricShells(kFine ? 5 : 4); }, 1.12},
      {"ThinSlab", [] { return ThinSlab(kFine ? 60 : 30); }, 0},
      {"ParallelTubes", [] { return ParallelTubes(0.01, 4, kFine ? 30 : 20, kFine ? 10 : 8); }, 1},
      {"NoisySphere", [] { return WithNoise(Icosphere(kFine ? 5 : 4), kFine ? 0.002 : 0.004, 7); }, 0},
      {"Ellipsoid",
       [] {
         return Ellipsoid(kFine ? 5 : 4, {2, 1, 0.5});
       },
       8},
      {"FarAway",
       [] {
         return Moved(Rotated(Scaled(Torus(1, 0.4, 80, 32), 3e-3), {1, 2, 3}, 1), {10, -20, 30});
       },
       833},
      {"Cube", [] { return Cube(kFine ? 20 : 10); }, 0},
      {"CappedCylinder", [] { return CappedCylinder(1, 2, kFine ? 64 : 32, kFine ? 20 : 10); }, 0},
  };
  return *shapes;
}

std::vector<ZooShape> SmoothZoo() {
  std::vector<ZooShape> smooth;
  for (const ZooShape& shape : Zoo()) {
    if (shape.max_curvature > 0) smooth.push_back(shape);
  }
  return smooth;
}

double FacetingError(const TriangleMesh& input, double max_curvature) {
  double longest = 0;
  for (const Triangle& t : input.triangles) {
    for (int i = 0; i < 3; ++i) {
      longest = std::max(longest, SquaredDistance(input.PositionAt(t[i]), input.PositionAt(t[(i + 1) % 3])));
    }
  }
  return max_curvature * longest / 6;
}

}  // namespace meshfront::testing
