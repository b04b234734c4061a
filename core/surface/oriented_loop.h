// An initial front, as those who find them hand it to those who advance them.
#pragma once

#include <vector>

#include "core/surface/surface.h"

namespace meshfront {

// A closed loop of at least three distinct places on one surface, last joined to first. The part of the surface that is still
// to be meshed lies on the right of each directed edge a → b, towards (b − a) × normal: the triangle that will grow from it is
// (b, a, apex), which runs along the edge as b → a. A loop along a rim therefore runs against the rim half-edges of the faces.
struct OrientedLoop {
  std::vector<SourcePoint> points;
};

}  // namespace meshfront
