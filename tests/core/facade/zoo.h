// The shapes that every property of the engine is tried on.
#pragma once

#include <ostream>
#include <string>
#include <vector>

#include "core/mesh/triangle_mesh.h"

// Coarser where everything is ten times slower.
#if defined(MESHFRONT_SANITIZED) || !defined(NDEBUG)
#define MESHFRONT_COARSE_ZOO
#endif

namespace meshfront::testing {

struct ZooShape {
  std::string name;
  TriangleMesh (*make)();
  // Largest principal curvature of the smooth surface that the triangles stand for; 0 where it has creases or noise, or is flat.
  double max_curvature;
};
inline void PrintTo(const ZooShape& shape, std::ostream* out) { *out << shape.name; }

const std::vector<ZooShape>& Zoo();
// Those of them that stand for a surface without creases and noise.
std::vector<ZooShape> SmoothZoo();

// How far the input's facets are from the smooth surface they stand for, at most: a triangle inside a circle of radius r on
// curvature κ is off by κ r² / 2, and r ≤ longest edge / √3 unless the triangle is obtuse (then r is half the edge).
double FacetingError(const TriangleMesh& input, double max_curvature);

}  // namespace meshfront::testing
