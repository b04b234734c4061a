// An initial front, as those who find them hand it to those who advance them.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "core/mesh/mesh_sink.h"
#include "core/surface/surface.h"

namespace meshfront {

// A closed loop of at least three distinct places on one surface, last joined to first. The part of the surface that is still
// to be meshed lies on the right of each directed edge a → b, towards (b − a) × normal: the triangle that will grow from it is
// (b, a, apex), which runs along the edge as b → a. A loop along a rim therefore runs against the rim half-edges of the faces.
//
// Along a crease two loops run in opposite directions through the same places, one on each side. Such a place is a *joint*: one
// vertex of the output, whichever loop's triangles use it.
struct OrientedLoop {
  std::vector<SourcePoint> points;
  std::vector<uint32_t> joints;  // of each point, the number of its joint or kNoJoint; empty: there are none
  // Whether the edge from each point to the next lies on a crease or on the border of a region, and stays as it is; empty: none does.
  std::vector<bool> creases;
  // Pairs of joints that an edge outside of what is meshed joins already: no edge of the output may.
  std::vector<std::pair<uint32_t, uint32_t>> taken;
};

}  // namespace meshfront
