// Ways over a mesh: where the plane through two of its points, upright on the surface, cuts it. Ours, for ground that is too
// rough for the paper's fences (sec. 3.4) to tell.
#pragma once

#include <vector>

#include "core/surface/mesh_walk.h"
#include "core/surface/surface.h"

namespace meshfront {

struct PlaceOnFace {
  uint32_t face;
  Vec3 position;
};

// The section from a to b with the plane that holds both and the direction `up` (any length), from face to face; false, and `way` as
// it was, when it does not lead there: it leaves over the rim, is longer than four times the distance, or passes by. A point on an
// edge or at a corner belongs to all the faces there. About 50 ns a face.
bool TraceWay(const FaceView& mesh, const PlaceOnFace& a, const PlaceOnFace& b, const Vec3& up,
              std::vector<WayPiece>& way);

}  // namespace meshfront
