// CastShadow: 1. weights in the triangle and heights over it of each face's corners; 2. the distance to a face, which is convex, is
// largest at a corner of what it covers of the triangle: under its own corners, and where its edges pass over the triangle's sides;
// 3. on to the faces across the edges that overlap the triangle.
#include "core/surface/shadow.h"

#include <algorithm>
#include <cmath>

#include "core/surface/face_queue.h"
#include "core/surface/tolerances.h"

namespace meshfront {
namespace {

using namespace surface_tolerances;

constexpr int Next(int corner) { return corner == 2 ? 0 : corner + 1; }

// A point against the triangle: its weights of the three corners, in the plane, and its height over that.
struct Over {
  double weight[3];
  double height;
};

class ShadowFrame {
 public:
  explicit ShadowFrame(const std::array<Vec3, 3>& t) : origin_(t[0]) {
    const Vec3 e1 = t[1] - t[0], e2 = t[2] - t[0], n = Cross(e1, e2);
    const double n2 = SquaredNorm(n);
    is_flat_ = !(n2 > 0);
    if (is_flat_) return;
    to_second_ = Cross(e2, n) / n2, to_third_ = Cross(n, e1) / n2, normal_ = n / std::sqrt(n2);
  }
  bool is_flat() const { return is_flat_; }
  Over At(const Vec3& p) const {
    const Vec3 d = p - origin_;
    const double v = Dot(d, to_second_), w = Dot(d, to_third_);
    return {{1 - v - w, v, w}, Dot(d, normal_)};
  }
  const Vec3& normal() const { return normal_; }

 private:
  Vec3 origin_, to_second_, to_third_, normal_;
  bool is_flat_ = false;
};

double LeastWeight(const Over& o) { return std::min({o.weight[0], o.weight[1], o.weight[2]}); }

// Both beyond one side of the triangle by more than `margin`.
bool LieBeside(const Over& a, const Over& b, double margin) {
  for (int i = 0; i < 3; ++i) {
    if (a.weight[i] < -margin && b.weight[i] < -margin) return true;
  }
  return false;
}

class ShadowCaster {
 public:
  ShadowCaster(const FaceView& mesh, const ShadowFrame& frame, const ShadowBounds& bounds, Shadow& shadow)
      : mesh_(mesh), frame_(frame), bound_(bounds.distance), beside_(bounds.beside), shadow_(shadow) {}

  void LookAt(uint32_t face, FaceQueue& queue) {
    Over corners[3];
    for (int i = 0; i < 3; ++i) corners[i] = frame_.At(mesh_.Corner(face, i));
    const bool is_far =
        std::max({std::abs(corners[0].height), std::abs(corners[1].height), std::abs(corners[2].height)}) > bound_;
    if (is_far && FacesTriangle(face)) Collect(face, corners);
    for (int i = 0; i < 3; ++i) {
      if (LieBeside(corners[i], corners[Next(i)], beside_)) continue;
      const uint32_t across = mesh_.opposite[3 * face + i];
      if (across != kNoHalfEdge)
        queue.Add({across / 3, 0, {}});
      else if (!LieBeside(corners[i], corners[Next(i)], 0))
        shadow_.is_whole = false;
    }
  }

 private:
  // What turns away lies under something that does not, or the triangle's edge does.
  bool FacesTriangle(uint32_t face) const {
    const Vec3& a = mesh_.Corner(face, 0);
    return Dot(Cross(mesh_.Corner(face, 1) - a, mesh_.Corner(face, 2) - a), frame_.normal()) > 0;
  }
  void Collect(uint32_t face, const Over (&corners)[3]) {
    for (int i = 0; i < 3; ++i) {
      const Over &a = corners[i], &b = corners[Next(i)];
      if (LeastWeight(a) >= -beside_) AddIfFar(face, i, 0, a);
      if (!LieBeside(a, b, 0)) CrossSides(face, i, a, b);
    }
  }
  void CrossSides(uint32_t face, int edge, const Over& a, const Over& b) {
    for (int side = 0; side < 3; ++side) {
      if ((a.weight[side] < 0) == (b.weight[side] < 0)) continue;
      const double t = a.weight[side] / (a.weight[side] - b.weight[side]);
      Over at;
      for (int i = 0; i < 3; ++i) at.weight[i] = a.weight[i] + t * (b.weight[i] - a.weight[i]);
      at.weight[side] = 0;
      at.height = a.height + t * (b.height - a.height);
      if (LeastWeight(at) >= 0) AddIfFar(face, edge, t, at);
    }
  }
  void AddIfFar(uint32_t face, int edge, double t, const Over& over) {
    if (!(std::abs(over.height) > bound_)) return;
    const Vec3 place = mesh_.Corner(face, edge) + t * (mesh_.Corner(face, Next(edge)) - mesh_.Corner(face, edge));
    const Vec3 below = place - over.height * frame_.normal();
    const bool is_vertex = t == 0;
    if (!is_vertex && !(ClosestOnFace(mesh_, face, below).squared_distance > bound_ * bound_)) return;
    for (const ShadowHit& known : shadow_.far) {
      if (known.above.position == place) return;  // from another face
    }
    double weights[3] = {0, 0, 0};
    weights[edge] = 1 - t, weights[Next(edge)] = t;
    shadow_.far.push_back({below, {face, weights[1], weights[2], place}, is_vertex, LeastWeight(over) < 0});
  }

  const FaceView& mesh_;
  const ShadowFrame& frame_;
  const double bound_, beside_;
  Shadow& shadow_;
};

}  // namespace

void CastShadow(const FaceView& mesh, uint32_t start, const std::array<Vec3, 3>& triangle, const ShadowBounds& bounds,
                Shadow& shadow) {
  shadow.far.clear();
  shadow.is_whole = true;
  const ShadowFrame frame(triangle);
  if (frame.is_flat()) {
    shadow.is_whole = false;
    return;
  }
  thread_local FaceQueue queue;
  queue.Clear();
  queue.Add({start, 0, {}});
  ShadowCaster caster(mesh, frame, bounds, shadow);
  for (size_t i = 0; i < queue.size(); ++i) {
    if (i == kMaxShadowFaces) {
      shadow.is_whole = false;
      return;
    }
    caster.LookAt(queue[i].face, queue);
  }
}

}  // namespace meshfront
