// Whether the normals of two neighbours are on the same side of the surface.
#pragma once

#include <cmath>

#include "core/geometry/vec3.h"

namespace meshfront {

struct SideComparison {
  double agreement;  // 1: the same side, -1: the other; near 0 it can't be told
  double doubt;  // 0: neither, where the points lie beside each other on a smooth surface; 2 on the sheets of a plate
};

// On the shortest bend from one to the other, a circle's arc, the normals mirror each other in the plane halfway: around an
// edge and on both sides of a thin plate as well as where it is flat, unlike their cosine.
inline SideComparison CompareSides(const Vec3& x, const Vec3& normal_x, const Vec3& y, const Vec3& normal_y) {
  const Vec3 way = Normalized(y - x);
  const double rise_x = Dot(normal_x, way), rise_y = Dot(normal_y, way);
  const double agreement = Dot(normal_x, normal_y) - 2 * rise_x * rise_y;
  return {agreement, 1 - std::abs(agreement) + rise_x * rise_x + rise_y * rise_y};
}

}  // namespace meshfront
