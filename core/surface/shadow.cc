// CastShadow: 1. weights in the triangle and heights over it of each face's corners; 2. the distance to a face, which is convex, is
// largest at a corner of what it covers of the triangle: under its own corners, where its edges pass over the triangle's sides, and at
// the triangle's corners; if that is beyond the bound, what it covers is doubtful; 3. on to the faces across the edges that overlap the
// triangle; 4. where one is a rim, the strip along a side that holds all of it is doubtful.
//
// That the faces cover all of the rest is seen at one place: faces that face the triangle less those that turn away lie over every
// place equally often, as no edge of what they make together passes over it.
#include "core/surface/shadow.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <memory>

#include "absl/base/attributes.h"
#include "core/base/processor.h"
#include "core/surface/face_queue.h"
#include "core/surface/tolerances.h"

namespace meshfront {
namespace {

using namespace surface_tolerances;

constexpr int Next(int corner) { return corner == 2 ? 0 : corner + 1; }

// Four doubles side by side. Each lane rounds as a scalar does, so that the processor's width changes no bit.
typedef double Quad __attribute__((vector_size(32)));
typedef int64_t Bits __attribute__((vector_size(32)));

// A point against the triangle: its weights of the three corners, in the plane, and its height over that.
struct alignas(16) Over {
  double weight[3];
  double height;
};

// Where the cover of the triangle is looked at: its weights are those of no place that anything symmetric would have an edge over.
constexpr double kProbe[3] = {0.3276041, 0.3391573, 0.3332386};

// A corner of a face, and what each of its faces asks about it, a bit each.
struct SeenCorner {
  static constexpr uint32_t kFar = 1;                // from the triangle's plane
  static constexpr uint32_t kBeside = 7u << 1;       // beyond side i by more than what belongs to it
  static constexpr uint32_t kOffProbe = 0x3fu << 4;  // by weight i lower, and not lower, than the probe
  static constexpr uint32_t kOutside = 7u << 10;     // beyond side i
  static constexpr uint32_t kFirstOutside = 1u << 10;
  static constexpr uint32_t kTold = 1u << 13;  // it is among the far places
  Over over;
  uint32_t code;
  static bool IsFarDetail(uint32_t code) { return (code & (kFar | kBeside)) == kFar; }
  static bool IsUntoldDetail(uint32_t code) { return (code & (kFar | kBeside | kTold)) == kFar; }
};
// A face that the search has reached, the places of its corners among those seen, and by which half-edge it was reached.
struct SeenFace {
  uint32_t face;
  uint32_t corner[3];
  int entered;  // 3: the first face
};

class ShadowFrame {
 public:
  explicit ShadowFrame(const std::array<Vec3, 3>& t) : corners_(t), origin_(t[0]) {
    const Vec3 e1 = t[1] - t[0], e2 = t[2] - t[0], n = Cross(e1, e2);
    const double n2 = SquaredNorm(n);
    is_flat_ = !(n2 > 0);
    if (is_flat_) return;
    const Vec3 to_second = Cross(e2, n) / n2, to_third = Cross(n, e1) / n2;
    normal_ = n / std::sqrt(n2);
    x_ = Quad{0, to_second.x, to_third.x, normal_.x};
    y_ = Quad{0, to_second.y, to_third.y, normal_.y};
    z_ = Quad{0, to_second.z, to_third.z, normal_.z};
  }
  bool is_flat() const { return is_flat_; }
  // Three weights and the height, as Over has them.
  ABSL_ATTRIBUTE_ALWAYS_INLINE void Place(const Vec3& p, Quad& over) const {
    const Vec3 d = p - origin_;
    over = d.x * x_ + d.y * y_ + d.z * z_;
    over[0] = 1 - over[1] - over[2];
  }
  const Vec3& normal() const { return normal_; }
  Vec3 PlaceOf(const double (&weight)[3]) const {
    return weight[0] * corners_[0] + weight[1] * corners_[1] + weight[2] * corners_[2];
  }

 private:
  std::array<Vec3, 3> corners_;
  Vec3 origin_, normal_;
  Quad x_, y_, z_;  // what to multiply with for the weights of the second and the third corner, and for the height
  bool is_flat_ = false;
};

double LeastWeight(const Over& o) { return std::min({o.weight[0], o.weight[1], o.weight[2]}); }

// Both beyond one side of the triangle, or no farther inside than `margin`.
bool LieBeside(const Over& a, const Over& b, double margin) {
  for (int i = 0; i < 3; ++i) {
    if (a.weight[i] < margin && b.weight[i] < margin) return true;
  }
  return false;
}

// A rim that lies no farther inside a side than this weight cuts nothing off: creases are straight, and sides lie on them.
constexpr double kOnRim = 1e-6;

// Twice the signed area of (a, b, q), in weights.
double TurnAround(const Over& a, const Over& b, const double (&q)[3]) {
  return (b.weight[1] - a.weight[1]) * (q[2] - a.weight[2]) - (b.weight[2] - a.weight[2]) * (q[1] - a.weight[1]);
}
// 1 where the place lies under a face that faces the triangle, −1 where under one that turns away, else 0.
int SideOver(const std::array<SeenCorner*, 3>& c, const double (&q)[3]) {
  const double s = TurnAround(c[0]->over, c[1]->over, q), t = TurnAround(c[1]->over, c[2]->over, q),
               u = TurnAround(c[2]->over, c[0]->over, q);
  return s >= 0 && t >= 0 && u >= 0 ? 1 : s <= 0 && t <= 0 && u <= 0 ? -1 : 0;
}

Over Between(const Over& a, const Over& b, double t) {
  Over at;
  for (int i = 0; i < 3; ++i) at.weight[i] = a.weight[i] + t * (b.weight[i] - a.weight[i]);
  at.height = a.height + t * (b.height - a.height);
  return at;
}

// A face cut off along sides of the triangle: each takes a corner away and adds two at most.
struct Polygon {
  Over corner[6];
  int size = 0;
  void Add(const Over& c) { corner[size++] = c; }
};

// What a polygon has on the inner side of a side of the triangle (Sutherland–Hodgman).
Polygon ClippedAgainst(int side, const Polygon& polygon) {
  Polygon clipped;
  for (int i = 0; i < polygon.size; ++i) {
    const Over &a = polygon.corner[i], &b = polygon.corner[i + 1 < polygon.size ? i + 1 : 0];
    const double from = a.weight[side], to = b.weight[side];
    if (from >= 0) clipped.Add(a);
    if ((from >= 0) != (to >= 0)) clipped.Add(Between(a, b, from / (from - to)));
  }
  return clipped;
}

class ShadowCaster {
 public:
  ShadowCaster(const FaceView& mesh, const ShadowFrame& frame, const ShadowBounds& bounds, Shadow& shadow)
      : mesh_(mesh),
        frame_(frame),
        bound_(bounds.distance),
        beside_(bounds.beside),
        with_doubtful_(bounds.with_doubtful),
        shadow_(shadow) {}

  // All faces over the triangle, from one on. False where they are too many.
  MESHFRONT_WIDE bool LookAtAll(uint32_t start) {
    scratch_.marks.Clear();
    scratch_.marks.Mark(start);
    for (int i = 0; i < 3; ++i) See(mesh_.Corner(start, i));
    scratch_.faces[face_count_++] = {start, {0, 1, 2}, 3};
    for (uint32_t i = 0; i < face_count_; ++i) {
      if (i == kMaxShadowFaces) return false;
      LookAt(scratch_.faces[i]);
    }
    return true;
  }
  // After the last face.
  void Finish() {
    shadow_.is_whole = cover_ > 0;
    for (int side = 0; side < 3; ++side) {
      if (strip_[side] >= kProbe[side]) shadow_.is_whole = false;
    }
    for (int side = 0; side < 3 && shadow_.is_whole && with_doubtful_; ++side) {
      if (strip_[side] > 0) AddStrip(side);
    }
  }

 private:
  ABSL_ATTRIBUTE_ALWAYS_INLINE void See(const Vec3& corner) {
    Quad over;
    frame_.Place(corner, over);
    // A lane for each weight; the height's asks nothing.
    static_assert(SeenCorner::kFar == 1 && SeenCorner::kBeside == 7u << 1 && SeenCorner::kOffProbe == 0x3fu << 4 &&
                  SeenCorner::kOutside == 7u << 10);
    const Bits beside = over < Quad{-beside_, -beside_, -beside_, -INFINITY};
    const Bits below = over < Quad{kProbe[0], kProbe[1], kProbe[2], -INFINITY};
    const Bits outside = over < Quad{0, 0, 0, -INFINITY};
    const Bits asked = (beside & Bits{1 << 1, 1 << 2, 1 << 3, 0}) | (outside & Bits{1 << 10, 1 << 11, 1 << 12, 0}) |
                       (below ? Bits{1 << 4, 1 << 5, 1 << 6, 0} : Bits{1 << 7, 1 << 8, 1 << 9, 0});
    SeenCorner& seen = scratch_.corners[corner_count_++];
    std::memcpy(&seen.over, &over, sizeof(over));
    seen.code = static_cast<uint32_t>(asked[0] | asked[1] | asked[2]) |
                static_cast<uint32_t>(std::abs(seen.over.height) > bound_);
  }
  ABSL_ATTRIBUTE_ALWAYS_INLINE void LookAt(const SeenFace& at) {
    const SeenCorner* const seen = scratch_.corners.get();
    const uint32_t code[3] = {seen[at.corner[0]].code, seen[at.corner[1]].code, seen[at.corner[2]].code};
    // What lies beyond one side has nothing over the triangle but corners that belong to it.
    const bool is_far =
        ((code[0] | code[1] | code[2]) & SeenCorner::kFar) != 0 &&
        ((code[0] & code[1] & code[2] & SeenCorner::kOutside) == 0 || SeenCorner::IsFarDetail(code[0]) ||
         SeenCorner::IsFarDetail(code[1]) || SeenCorner::IsFarDetail(code[2]));
    const bool may_cover = (code[0] & code[1] & code[2] & SeenCorner::kOffProbe) == 0;
    if (is_far || may_cover) Consider(at, is_far, may_cover);
    for (int i = 0; i < 3; ++i) {
      const int next = Next(i);
      if (i == at.entered || (code[i] & code[next] & SeenCorner::kBeside) != 0) continue;
      const uint32_t across = mesh_.opposite[3 * at.face + i];
      if (across != kNoHalfEdge)
        Reach(across, at.corner[next], at.corner[i]);
      else
        MeetRim(at.face, scratch_.corners[at.corner[i]].over, scratch_.corners[at.corner[next]].over);
    }
  }
  void Consider(const SeenFace& at, bool is_far, bool may_cover) {
    SeenCorner* const seen = scratch_.corners.get();
    const std::array<SeenCorner*, 3> corners = {&seen[at.corner[0]], &seen[at.corner[1]], &seen[at.corner[2]]};
    if (is_far) Collect(at.face, corners);
    if (may_cover) cover_ += SideOver(corners, kProbe);
  }
  // The face of a half-edge whose ends have been seen.
  ABSL_ATTRIBUTE_ALWAYS_INLINE void Reach(uint32_t half_edge, uint32_t from, uint32_t to) {
    const uint32_t face = half_edge / 3;
    if (!scratch_.marks.Mark(face)) return;
    const int first = static_cast<int>(half_edge % 3), second = Next(first), third = Next(second);
    SeenFace& reached = scratch_.faces[face_count_++];
    reached.face = face, reached.entered = first;
    reached.corner[first] = from, reached.corner[second] = to, reached.corner[third] = corner_count_;
    See(mesh_.Corner(face, third));
  }
  void MeetRim(uint32_t face, const Over& a, const Over& b) {
    if (!LieBeside(a, b, kOnRim)) WidenStrip(face, a, b);
  }
  // Makes one of the strips along the triangle's sides hold the edge of a rim.
  void WidenStrip(uint32_t face, const Over& a, const Over& b) {
    // What of it lies over the triangle.
    double begin = 0, end = 1;
    for (int side = 0; side < 3; ++side) {
      const double from = a.weight[side], to = b.weight[side];
      if ((from < 0) == (to < 0)) continue;
      const double t = from / (from - to);
      from < 0 ? begin = std::max(begin, t) : end = std::min(end, t);
    }
    if (begin > end) return;
    const Over p = Between(a, b, begin), q = Between(a, b, end);
    int next_to = 0;
    const auto width = [&](int side) { return std::max(p.weight[side], q.weight[side]); };
    for (int side = 1; side < 3; ++side) {
      if (width(side) < width(next_to)) next_to = side;
    }
    if (!(width(next_to) > strip_[next_to])) return;
    strip_[next_to] = width(next_to), strip_face_[next_to] = face;
  }
  // Side i is what faces corner i here.
  void AddStrip(int side) {
    const double width = strip_[side];
    double corner[2][2][3] = {};  // at either end of it: on the side, and away from it
    for (int end = 0; end < 2; ++end) {
      const int at = (side + 1 + end) % 3;
      corner[end][0][at] = 1;
      corner[end][1][at] = 1 - width, corner[end][1][side] = width;
    }
    const Vec3 a = frame_.PlaceOf(corner[0][0]), b = frame_.PlaceOf(corner[1][0]), c = frame_.PlaceOf(corner[1][1]),
               d = frame_.PlaceOf(corner[0][1]);
    shadow_.doubtful.push_back({{a, b, c}, strip_face_[side]});
    shadow_.doubtful.push_back({{a, c, d}, strip_face_[side]});
  }
  // What turns away lies under something that does not, or the triangle's edge does.
  bool FacesTriangle(uint32_t face) const {
    const Vec3& a = mesh_.Corner(face, 0);
    return Dot(Cross(mesh_.Corner(face, 1) - a, mesh_.Corner(face, 2) - a), frame_.normal()) > 0;
  }
  void Collect(uint32_t face, const std::array<SeenCorner*, 3>& corners) {
    for (int i = 0; i < 3; ++i) {
      SeenCorner &a = *corners[i], &b = *corners[Next(i)];
      if (SeenCorner::IsUntoldDetail(a.code) && AddIfFar(face, i, 0, a.over)) a.code |= SeenCorner::kTold;
      // Heights are largest at the ends of an edge.
      if (((a.code | b.code) & SeenCorner::kFar) != 0 && (a.code & b.code & SeenCorner::kOutside) == 0)
        CrossSides(face, i, a, b);
    }
    if (with_doubtful_) AddIfDoubtful(face, corners);
  }
  // What the face covers of the triangle, if a corner of that is too far from it.
  void AddIfDoubtful(uint32_t face, const std::array<SeenCorner*, 3>& corners) {
    if (!FacesTriangle(face)) return;
    Polygon covered{{corners[0]->over, corners[1]->over, corners[2]->over}, 3};
    for (int side = 0; side < 3 && covered.size > 0; ++side) covered = ClippedAgainst(side, covered);
    const auto is_far = [&](const Over& at) {
      return std::abs(at.height) > bound_ &&
             ClosestOnFace(mesh_, face, frame_.PlaceOf(at.weight)).squared_distance > bound_ * bound_;
    };
    if (std::none_of(covered.corner, covered.corner + covered.size, is_far)) return;
    const auto place = [&](int i) { return frame_.PlaceOf(covered.corner[i].weight); };
    for (int i = 1; i + 1 < covered.size; ++i) shadow_.doubtful.push_back({{place(0), place(i), place(i + 1)}, face});
  }
  void CrossSides(uint32_t face, int edge, const SeenCorner& from, const SeenCorner& to) {
    const uint32_t crossed = (from.code ^ to.code) & SeenCorner::kOutside;
    const Over &a = from.over, &b = to.over;
    for (int side = 0; side < 3; ++side) {
      if ((crossed >> side & SeenCorner::kFirstOutside) == 0) continue;
      const double t = a.weight[side] / (a.weight[side] - b.weight[side]);
      Over at = Between(a, b, t);
      at.weight[side] = 0;
      if (LeastWeight(at) >= 0) AddIfFar(face, edge, t, at);
    }
  }
  // Whether it is among the far places.
  bool AddIfFar(uint32_t face, int edge, double t, const Over& over) {
    if (!(std::abs(over.height) > bound_) || !FacesTriangle(face)) return false;
    const Vec3 place = mesh_.Corner(face, edge) + t * (mesh_.Corner(face, Next(edge)) - mesh_.Corner(face, edge));
    const Vec3 below = place - over.height * frame_.normal();
    const bool is_vertex = t == 0;
    if (!is_vertex && !(ClosestOnFace(mesh_, face, below).squared_distance > bound_ * bound_)) return false;
    for (const ShadowHit& known : shadow_.far) {
      if (known.above.position == place) return true;  // from another face
    }
    double weights[3] = {0, 0, 0};
    weights[edge] = 1 - t, weights[Next(edge)] = t;
    shadow_.far.push_back({below, {face, weights[1], weights[2], place}, is_vertex, LeastWeight(over) < 0});
    return true;
  }

  // To be kept for each thread.
  struct Scratch {
    static constexpr size_t kMost =
        2 * kMaxShadowFaces + 3;  // each face reaches two more, and each of those adds a corner
    std::unique_ptr<SeenFace[]> faces = std::make_unique_for_overwrite<SeenFace[]>(kMost);
    std::unique_ptr<SeenCorner[]> corners = std::make_unique_for_overwrite<SeenCorner[]>(kMost);
    FaceMarks marks;
  };
  static Scratch& ThreadScratch() {
    thread_local Scratch scratch;
    return scratch;
  }

  const FaceView& mesh_;
  const ShadowFrame& frame_;
  const double bound_, beside_;
  const bool with_doubtful_;
  Shadow& shadow_;
  Scratch& scratch_ = ThreadScratch();
  uint32_t face_count_ = 0, corner_count_ = 0;  // of those in the scratch
  int cover_ = 0;                               // of the probe
  double strip_[3] = {};  // weights up to which rims pass along the triangle's sides, by the corner across
  uint32_t strip_face_[3] = {};
};

}  // namespace

void CastShadow(const FaceView& mesh, uint32_t start, const std::array<Vec3, 3>& triangle, const ShadowBounds& bounds,
                Shadow& shadow) {
  shadow.far.clear();
  shadow.doubtful.clear();
  shadow.is_whole = true;
  const ShadowFrame frame(triangle);
  if (frame.is_flat()) {
    shadow.is_whole = false;
    return;
  }
  ShadowCaster caster(mesh, frame, bounds, shadow);
  if (!caster.LookAtAll(start)) {
    shadow.is_whole = false;
    return;
  }
  caster.Finish();
}

}  // namespace meshfront
