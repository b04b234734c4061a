// DescendToClosest: 1. run ahead over the side that the target lies beyond (WalkTowards), which is cheap; 2. ClosestOnFrame
// there, if that is closer than at the start; 3. if the point lies inside, done; 4. on an edge look across it, at a corner look around
// it (ClosestAround); 5. move while the distance strictly decreases. The distance of a face is a function of the face alone, so a
// strict decrease can't come back to one.
// WalkToCircle: 1. descend to the face under the circle's middle of the open side; 2. cross the circle with that face's plane;
// 3. the crossing inside the face is the hit, else go on over the edge that it lies beyond.
//
//            circle, seen along the axis            Rejected: stepping by the closest point alone. It lands beside the circle
//              ..--o--..   o  = hit                 on curved faces, so that edge lengths are only nearly those asked for
//      a,b --> c---+--- )  -+- = section of mesh    (the prototype's flaw).
#include "core/surface/mesh_walk.h"

#include <algorithm>
#include <cmath>

#include "core/surface/tolerances.h"

namespace meshfront {
namespace {

using namespace surface_tolerances;

// When the closest point of a face can be bounded at once: the squared sine at its corner 0 is above this, and the target
// lies beyond a side by this part of the height over it.
constexpr double kFlatSineSquared = 1e-6, kClearlyBeyond = 1e-3;

constexpr int Next(int corner) { return corner == 2 ? 0 : corner + 1; }
constexpr int Previous(int corner) { return corner == 0 ? 2 : corner - 1; }

// Replaces `best` by the closest point of half-edge `edge` when that is closer.
void KeepCloserOnEdge(const FaceView& mesh, uint32_t face, int edge, const Vec3& target, WalkPoint& best) {
  const Vec3& from = mesh.Corner(face, edge);
  const Vec3 along = mesh.Corner(face, Next(edge)) - from;
  const double length2 = SquaredNorm(along);
  double t = length2 > 0 ? Dot(target - from, along) / length2 : 0;
  t = std::clamp(t, 0.0, 1.0);
  const Vec3 position = from + t * along;
  const double d2 = SquaredDistance(target, position);
  if (!(d2 < best.squared_distance)) return;
  double weights[3] = {0, 0, 0};
  weights[edge] = 1 - t;
  weights[Next(edge)] = t;
  best.hit = {face, weights[1], weights[2], position};
  best.squared_distance = d2;
  best.region = t <= 0 ? 4 + edge : t >= 1 ? 4 + Next(edge) : 1 + edge;
}

// The closest point over the faces around a corner; `best` is what is known already.
WalkPoint ClosestAround(const FaceView& mesh, const WalkPoint& best, const Vec3& target) {
  WalkPoint closest = best;
  const uint32_t start = best.hit.face;
  const int start_corner = best.region - 4;
  uint32_t face = start;
  int corner = start_corner;
  for (;;) {  // over the half-edge that comes in, until round or at the rim
    const uint32_t across = mesh.opposite[3 * face + Previous(corner)];
    if (across == kNoHalfEdge) break;
    face = across / 3, corner = static_cast<int>(across % 3);
    if (face == start) return closest;
    const WalkPoint other = ClosestOnFace(mesh, face, target);
    if (other.squared_distance < closest.squared_distance) closest = other;
  }
  for (face = start, corner = start_corner;;) {  // and the other way
    const uint32_t across = mesh.opposite[3 * face + corner];
    if (across == kNoHalfEdge) return closest;
    face = across / 3, corner = Next(static_cast<int>(across % 3));
    if (face == start) return closest;
    const WalkPoint other = ClosestOnFace(mesh, face, target);
    if (other.squared_distance < closest.squared_distance) closest = other;
  }
}

// Two doubles side by side. Each lane rounds as a scalar does, so pairs change no bit.
typedef double Pair __attribute__((vector_size(16)));
inline Pair Swapped(const Pair& p) { return Pair{p[1], p[0]}; }

// A face as the target sees it: its sides from corner 0, their products, and where the target lies along its normal: weights
// of corner 1 and 2 times `det`, which is 4 × area². Pairs belong to these two corners.
struct FaceFrame {
  const Vec3* corner;
  Pair x, y, z;    // the sides
  Pair squares;    // their squared lengths
  double product;  // their dot product
  double det, u, v;

  FaceFrame(const FaceView& mesh, uint32_t face, const Vec3& target) {
    const Vec3 &a = mesh.Corner(face, 0), &b = mesh.Corner(face, 1), &c = mesh.Corner(face, 2);
    corner = &a;
    x = Pair{b.x, c.x} - a.x, y = Pair{b.y, c.y} - a.y, z = Pair{b.z, c.z} - a.z;
    squares = x * x + y * y + z * z;
    product = x[0] * x[1] + y[0] * y[1] + z[0] * z[1];
    const Pair along = (target.x - a.x) * x + (target.y - a.y) * y + (target.z - a.z) * z;
    det = squares[0] * squares[1] - product * product;
    const Pair weights = Swapped(squares) * along - product * Swapped(along);
    u = weights[0], v = weights[1];
  }
  bool IsInside() const { return det > 0 && u >= 0 && v >= 0 && u + v <= det; }
  FaceHit HitInside(uint32_t face) const {
    const double s = u / det, t = v / det;
    return {face, s, t, *corner + s * Vec3{x[0], y[0], z[0]} + t * Vec3{x[1], y[1], z[1]}};
  }
  // Whether no point of the face is as near as that, seen at once: the target lies beyond one of its sides by more.
  bool IsFartherThan(double squared_distance) const {
    if (!(det > kFlatSineSquared * squares[0] * squares[1])) return false;
    const auto is_beyond = [&](double weight, double side2) {
      return weight < -kClearlyBeyond * det && squared_distance * det * side2 < 0.5 * weight * weight;
    };
    return is_beyond(u, squares[1]) || is_beyond(v, squares[0]) ||
           is_beyond(det - u - v, squares[0] + squares[1] - 2 * product);
  }
};

WalkPoint ClosestOnFrame(const FaceView& mesh, uint32_t face, const FaceFrame& frame, const Vec3& target) {
  WalkPoint best;
  if (frame.IsInside()) {
    best.hit = frame.HitInside(face);
    best.squared_distance = SquaredDistance(target, best.hit.position);
    return best;
  }
  // Only an edge that the target lies beyond can hold the closest point; a face without area has no inside, so all can.
  best.squared_distance = INFINITY;
  best.hit = {face, 0, 0, *frame.corner};
  best.region = 4;
  const bool flat = !(frame.det > 0);
  if (flat || frame.v < 0) KeepCloserOnEdge(mesh, face, 0, target, best);
  if (flat || frame.u + frame.v > frame.det) KeepCloserOnEdge(mesh, face, 1, target, best);
  if (flat || frame.u < 0) KeepCloserOnEdge(mesh, face, 2, target, best);
  return best;
}

// From `face`, whose frame is given, to the face over which the target lies, or where the way there ends: at a rim, at a
// ridge (the way back is the only one), or in a circle, found by comparing with the face of the last step that was a power
// of two. The frame becomes that face's.
uint32_t WalkTowards(const FaceView& mesh, uint32_t face, const Vec3& target, FaceFrame& frame) {
  uint32_t before = kNoHalfEdge, marked = face;
  for (uint32_t step = 1, mark = 1; step < kMaxWalkSteps; ++step) {
    const double beyond[3] = {-frame.v, -(frame.det - frame.u - frame.v),
                              -frame.u};  // of the corner that half-edge i faces
    uint32_t next = kNoHalfEdge;
    double farthest = 0;
    for (int side = 0; side < 3; ++side) {
      if (!(beyond[side] > farthest)) continue;
      const uint32_t across = mesh.opposite[3 * face + side];
      if (across == kNoHalfEdge || across / 3 == before) continue;
      farthest = beyond[side];
      next = across / 3;
    }
    if (next == kNoHalfEdge || next == marked) break;
    before = face;
    face = next;
    frame = FaceFrame(mesh, face, target);
    if (step == mark) marked = face, mark *= 2;
  }
  return face;
}

}  // namespace

WalkPoint ClosestOnFace(const FaceView& mesh, uint32_t face, const Vec3& target) {
  return ClosestOnFrame(mesh, face, FaceFrame(mesh, face, target), target);
}

FaceHit DescendToClosest(const FaceView& mesh, uint32_t start, const Vec3& target) {
  const FaceFrame at_start(mesh, start, target);
  if (at_start.IsInside()) return at_start.HitInside(start);
  FaceFrame frame = at_start;
  const uint32_t ahead = WalkTowards(mesh, start, target, frame);
  WalkPoint best = ClosestOnFrame(mesh, ahead, frame, target);
  if (ahead != start && !at_start.IsFartherThan(best.squared_distance)) {
    const WalkPoint here = ClosestOnFrame(mesh, start, at_start, target);
    if (!(best.squared_distance < here.squared_distance)) best = here;
  }
  while (best.region != 0) {
    WalkPoint other;
    if (best.region >= 4) {
      other = ClosestAround(mesh, best, target);
    } else {
      const uint32_t across = mesh.opposite[3 * best.hit.face + best.region - 1];
      if (across == kNoHalfEdge) break;
      other = ClosestOnFace(mesh, across / 3, target);
    }
    if (!(other.squared_distance < best.squared_distance)) break;
    best = other;
  }
  return best.hit;
}

PlaneCrossings CrossFacePlane(const FaceView& mesh, uint32_t face, const PlacementCircle& circle) {
  const Vec3& p = mesh.Corner(face, 0);
  const Vec3 normal = Cross(mesh.Corner(face, 1) - p, mesh.Corner(face, 2) - p);
  // In the circle's plane the face's plane is the line  centre + (d / |m|²) m + s (axis × m), with m the normal's part there.
  const Vec3 m = normal - Dot(normal, circle.axis) * circle.axis;
  const double m2 = SquaredNorm(m);
  if (!(m2 > kParallelSquared * SquaredNorm(normal))) return {};
  const double offset = Dot(normal, p - circle.center) / m2;
  const double chord2 = circle.radius * circle.radius - offset * offset * m2;
  if (!(chord2 >= 0)) return {};
  const Vec3 foot = circle.center + offset * m;
  Vec3 along = std::sqrt(chord2 / m2) * Cross(circle.axis, m);
  if (Dot(along, circle.side) < 0) along = -along;
  return {2, {foot + along, foot - along}};
}

std::optional<FaceHit> HitInFace(const FaceView& mesh, uint32_t face, const Vec3& point, int* across) {
  const Vec3& a = mesh.Corner(face, 0);
  const Vec3 e1 = mesh.Corner(face, 1) - a, e2 = mesh.Corner(face, 2) - a, d = point - a;
  const Vec3 normal = Cross(e1, e2);
  const double n2 = SquaredNorm(normal);
  *across = 0;
  if (!(n2 > 0)) return std::nullopt;
  double u = Dot(Cross(d, e2), normal) / n2, v = Dot(Cross(e1, d), normal) / n2;
  const double w = 1 - u - v;
  const double worst = std::min({u, v, w});
  *across = worst == v ? 0 : worst == w ? 1 : 2;  // the half-edge that faces the corner of the smallest weight
  if (!(worst >= -kFaceSlack)) return std::nullopt;
  u = std::clamp(u, 0.0, 1.0);
  v = std::clamp(v, 0.0, 1.0 - u);
  return FaceHit{face, u, v, point};
}

std::optional<FaceHit> WalkToCircle(const FaceView& mesh, uint32_t start, const PlacementCircle& circle) {
  uint32_t face = DescendToClosest(mesh, start, circle.center + circle.radius * circle.side).face;
  uint32_t before = kNoHalfEdge;
  for (int step = 0; step < kMaxCircleSteps; ++step) {
    const PlaneCrossings crossings = CrossFacePlane(mesh, face, circle);
    if (crossings.count == 0) return std::nullopt;
    int beyond = 0;
    if (auto hit = HitInFace(mesh, face, crossings.points[0], &beyond)) return hit;
    const uint32_t across = mesh.opposite[3 * face + beyond];
    if (across == kNoHalfEdge || across / 3 == before) return std::nullopt;
    before = face;
    face = across / 3;
  }
  return std::nullopt;
}

}  // namespace meshfront
