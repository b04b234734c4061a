// What of a mesh lies over a triangle, seen along its normal, and where the two are far apart (engine sec. 3, error mode).
#pragma once

#include <array>
#include <vector>

#include "core/surface/mesh_walk.h"

namespace meshfront {

// A place of the triangle and what lies over it.
struct ShadowHit {
  Vec3 below;
  FaceHit above;
  bool is_vertex = false;  // of the mesh
  bool is_beside = false;  // outside the triangle
};
struct ShadowBounds {
  double distance = 0;        // absolute
  double beside = 0;          // vertices beside the triangle, by this weight, belong to it, too
  bool with_doubtful = true;  // parts are wanted
};
// A part of the triangle that may be farther than the bound, and a face over it or next to it.
struct ShadowPart {
  std::array<Vec3, 3> corners;
  uint32_t face;
};
struct Shadow {
  std::vector<ShadowHit> far;
  std::vector<ShadowPart> doubtful;
  bool is_whole = true;  // all of the triangle that is not doubtful has been found to keep the bound
};

// Collects the places farther apart than the bound between a triangle and the faces over it, reached from face `start`, which should
// lie over it, from side to side: vertices along the normal, places of the triangle from the face over them. Where it is whole, the
// triangle is nowhere farther from the mesh but in the doubtful parts: those under a face that is too far from one of their corners
// (another may be nearer), and what lies beyond a rim. It is not where faces are too many, or none lies over it. About 0.1 µs a face.
void CastShadow(const FaceView& mesh, uint32_t start, const std::array<Vec3, 3>& triangle, const ShadowBounds& bounds,
                Shadow& shadow);

}  // namespace meshfront
