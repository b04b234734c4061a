// Edges across which a mesh turns by more than an angle: what creases are without any judgement.
#pragma once

#include <cmath>
#include <numbers>
#include <vector>

#include "core/geometry/triangle.h"
#include "core/mesh/adjacency.h"
#include "core/mesh/triangle_mesh.h"

namespace meshfront::testing {

inline Vec3 FaceNormal(const TriangleMesh& mesh, uint32_t face) {
  const Triangle& t = mesh.triangles[face];
  return Normalized(AreaVector(mesh.PositionAt(t[0]), mesh.PositionAt(t[1]), mesh.PositionAt(t[2])));
}

// One flag per half-edge, as the surface is cut along them; none on rims.
inline std::vector<bool> SharpEdges(const TriangleMesh& mesh, const FaceAdjacency& adjacency, double degrees = 40) {
  const double cosine = std::cos(degrees * std::numbers::pi / 180);
  std::vector<bool> sharp(3 * mesh.triangles.size(), false);
  for (uint32_t h = 0; h < sharp.size(); ++h) {
    const uint32_t across = adjacency.OppositeOf(h);
    if (across == kNoHalfEdge) continue;
    sharp[h] = Dot(FaceNormal(mesh, FaceOfHalfEdge(h)), FaceNormal(mesh, FaceOfHalfEdge(across))) < cosine;
  }
  return sharp;
}

struct Segment {
  Vec3 from, to;
};

inline double DistanceTo(const Segment& s, const Vec3& p) {
  const Vec3 along = s.to - s.from;
  const double t = Dot(p - s.from, along) / SquaredNorm(along);
  return Distance(p, s.from + std::fmin(std::fmax(t, 0.0), 1.0) * along);
}

// Each flagged edge once.
inline std::vector<Segment> SegmentsOf(const TriangleMesh& mesh, const FaceAdjacency& adjacency,
                                       const std::vector<bool>& flags) {
  std::vector<Segment> segments;
  for (uint32_t h = 0; h < flags.size(); ++h) {
    if (flags[h] && h < adjacency.OppositeOf(h))
      segments.push_back({mesh.PositionAt(OriginOf(mesh, h)), mesh.PositionAt(TargetOf(mesh, h))});
  }
  return segments;
}

}  // namespace meshfront::testing
