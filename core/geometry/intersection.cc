// Triangles against triangles, cheapest test first:
//
// 1. boxes apart (only without shared corners);
// 2. all corners of one strictly on one side of the other's plane (PlaneOf: one normal for three corners, with an error
//    bound);
// 3. a side of one meets the other (SideMeets). Without shared corners any of six will do. With one shared corner only
//    the sides opposite to it count: from the shared corner, common points reach up to where one triangle ends. With
//    two shared corners the triangles have more in common only when they are folded onto each other.
// Rejected: intervals on the planes' common line; fewer determinants for pairs that do meet, which are the rare ones.
#include "core/geometry/intersection.h"

#include "core/geometry/predicates.h"

namespace meshfront {
namespace {

double LargestComponent(const Vec3& v) { return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}); }

// The plane of a triangle; SideOf(p) is Orient3d(t0, t1, t2, p).
class Plane {
 public:
  explicit Plane(const Vec3 (&t)[3]) : t_(t) {
    const Vec3 u = t[1] - t[0], v = t[2] - t[0];
    normal_ = Cross(u, v);
    // Six terms of at most this, eight roundings each.
    error_ = 64 * 0x1p-53 * LargestComponent(u) * LargestComponent(v);
  }
  int SideOf(const Vec3& p) const {
    const Vec3 d = p - t_[0];
    const double height = Dot(normal_, d), error = error_ * LargestComponent(d);
    if (height > error) return 1;
    if (height < -error) return -1;
    return Orient3d(t_[0], t_[1], t_[2], p);
  }

 private:
  const Vec3 (&t_)[3];
  Vec3 normal_;
  double error_;
};

bool IsBetween(const Vec2& p, const Vec2& a, const Vec2& b) {  // on the line through a and b
  return std::min(a.x, b.x) <= p.x && p.x <= std::max(a.x, b.x) && std::min(a.y, b.y) <= p.y &&
         p.y <= std::max(a.y, b.y);
}

bool SegmentsMeet(const Vec2& p, const Vec2& q, const Vec2& r, const Vec2& s) {
  const int pr = Orient2d(r, s, p), qr = Orient2d(r, s, q), rp = Orient2d(p, q, r), sp = Orient2d(p, q, s);
  if (pr * qr < 0 && rp * sp < 0) return true;
  return (pr == 0 && IsBetween(p, r, s)) || (qr == 0 && IsBetween(q, r, s)) || (rp == 0 && IsBetween(r, p, q)) ||
         (sp == 0 && IsBetween(s, p, q));
}

// An axis along which the triangle's projection keeps an area; −1 when it has none.
int ProjectionAxis(const Vec3 (&t)[3]) {
  for (int axis = 0; axis < 3; ++axis) {
    if (Orient2d(DropAxis(t[0], axis), DropAxis(t[1], axis), DropAxis(t[2], axis)) != 0) return axis;
  }
  return -1;
}

// All in one plane.
bool CoplanarSegmentMeets(const Vec3& p, const Vec3& q, const Vec3 (&triangle)[3]) {
  const int axis = ProjectionAxis(triangle);
  if (axis < 0) return false;
  const Vec2 u = DropAxis(p, axis), v = DropAxis(q, axis);
  const Vec2 t[3] = {DropAxis(triangle[0], axis), DropAxis(triangle[1], axis), DropAxis(triangle[2], axis)};
  const int s0 = Orient2d(t[0], t[1], u), s1 = Orient2d(t[1], t[2], u), s2 = Orient2d(t[2], t[0], u);
  if (!((s0 < 0 || s1 < 0 || s2 < 0) && (s0 > 0 || s1 > 0 || s2 > 0))) return true;  // p inside
  return SegmentsMeet(u, v, t[0], t[1]) || SegmentsMeet(u, v, t[1], t[2]) || SegmentsMeet(u, v, t[2], t[0]);
}

// The segment pq, whose ends lie on the given sides of the triangle's plane.
bool SideMeets(const Vec3& p, const Vec3& q, int p_side, int q_side, const Vec3 (&t)[3]) {
  if (p_side * q_side > 0) return false;
  if (p_side == 0 && q_side == 0) return CoplanarSegmentMeets(p, q, t);
  const int s0 = Orient3d(p, q, t[0], t[1]), s1 = Orient3d(p, q, t[1], t[2]);
  if (s0 * s1 < 0) return false;
  const int s2 = Orient3d(p, q, t[2], t[0]);
  return s0 * s2 >= 0 && s1 * s2 >= 0;
}

bool BoxesApart(const Vec3 (&a)[3], const Vec3 (&b)[3]) {
  for (int i = 0; i < 3; ++i) {
    if (std::max({a[0][i], a[1][i], a[2][i]}) < std::min({b[0][i], b[1][i], b[2][i]})) return true;
    if (std::max({b[0][i], b[1][i], b[2][i]}) < std::min({a[0][i], a[1][i], a[2][i]})) return true;
  }
  return false;
}

bool HaveArea(const Vec3 (&a)[3], const Vec3 (&b)[3]) { return ProjectionAxis(a) >= 0 && ProjectionAxis(b) >= 0; }

bool IntersectApart(const Vec3 (&a)[3], const Vec3 (&b)[3]) {
  if (BoxesApart(a, b)) return false;
  const auto sides_of = [](const Vec3(&points)[3], const Vec3(&t)[3]) {
    const Plane plane(t);
    return std::array<int, 3>{plane.SideOf(points[0]), plane.SideOf(points[1]), plane.SideOf(points[2])};
  };
  const auto one_side = [](const std::array<int, 3>& s) { return s[0] != 0 && s[0] == s[1] && s[1] == s[2]; };
  const std::array<int, 3> a_sides = sides_of(a, b);
  if (one_side(a_sides)) return false;
  const std::array<int, 3> b_sides = sides_of(b, a);
  if (one_side(b_sides)) return false;
  for (int i = 0; i < 3; ++i) {
    const int j = i == 2 ? 0 : i + 1;
    if (SideMeets(a[i], a[j], a_sides[i], a_sides[j], b) || SideMeets(b[i], b[j], b_sides[i], b_sides[j], a)) {
      return HaveArea(a, b);
    }
  }
  return false;
}

// Corner i of a is corner k of b.
bool IntersectAtCorner(const Vec3 (&a)[3], const Vec3 (&b)[3], int i, int k) {
  const Vec3 &a1 = a[(i + 1) % 3], &a2 = a[(i + 2) % 3], &b1 = b[(k + 1) % 3], &b2 = b[(k + 2) % 3];
  const Plane b_plane(b);
  const int a1_side = b_plane.SideOf(a1), a2_side = b_plane.SideOf(a2);
  if (a1_side * a2_side > 0) return false;
  const Plane a_plane(a);
  const int b1_side = a_plane.SideOf(b1), b2_side = a_plane.SideOf(b2);
  if (b1_side * b2_side > 0) return false;
  return (SideMeets(a1, a2, a1_side, a2_side, b) || SideMeets(b1, b2, b1_side, b2_side, a)) && HaveArea(a, b);
}

// Corners i and j of a are shared; `apex` is the corner of b that is not.
bool IsFoldedOnto(const Vec3 (&a)[3], int i, int j, const Vec3& apex) {
  if (Plane(a).SideOf(apex) != 0) return false;
  const int axis = ProjectionAxis(a);
  if (axis < 0) return false;
  const Vec2 p = DropAxis(a[i], axis), q = DropAxis(a[j], axis);
  return Orient2d(p, q, DropAxis(a[3 - i - j], axis)) * Orient2d(p, q, DropAxis(apex, axis)) > 0;
}

}  // namespace

SharedCorners SharedCornersOf(const std::array<VertexId, 3>& a, const std::array<VertexId, 3>& b) {
  SharedCorners out;
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k) {
      if (a[i] == b[k]) out.in_b[i] = k;
    }
    out.count += out.in_b[i] >= 0;
  }
  return out;
}

bool TrianglesIntersect(const Vec3 (&a)[3], const Vec3 (&b)[3], const SharedCorners& shared) {
  if (shared.count == 0) return IntersectApart(a, b);
  if (shared.count == 3) return HaveArea(a, b);
  if (shared.count == 1) {
    const int i = shared.in_b[0] >= 0 ? 0 : shared.in_b[1] >= 0 ? 1 : 2;
    return IntersectAtCorner(a, b, i, shared.in_b[i]);
  }
  const int lone = shared.in_b[0] < 0 ? 0 : shared.in_b[1] < 0 ? 1 : 2, i = (lone + 1) % 3, j = (lone + 2) % 3;
  return IsFoldedOnto(a, i, j, b[3 - shared.in_b[i] - shared.in_b[j]]);
}

bool SegmentMeetsTriangle(const Vec3& p, const Vec3& q, const Vec3 (&triangle)[3]) {
  const Plane plane(triangle);
  return SideMeets(p, q, plane.SideOf(p), plane.SideOf(q), triangle) && ProjectionAxis(triangle) >= 0;
}

// The ends are places where a side of one passes through the other.
std::optional<std::array<Vec3, 2>> CommonStretch(const Vec3 (&a)[3], const Vec3 (&b)[3]) {
  std::array<Vec3, 6> places;
  size_t count = 0;
  const auto collect = [&](const Vec3(&sides)[3], const Vec3(&through)[3]) {
    const Vec3 normal = Cross(through[1] - through[0], through[2] - through[0]);
    for (int i = 0; i < 3; ++i) {
      const Vec3 &p = sides[i], &q = sides[(i + 1) % 3];
      const double from = Dot(normal, p - through[0]), to = Dot(normal, q - through[0]);
      if ((from > 0) == (to > 0)) continue;
      const Vec3 x = p + from / (from - to) * (q - p);
      bool is_inside = true;
      for (int k = 0; k < 3; ++k)
        is_inside = is_inside && Dot(normal, Cross(through[(k + 1) % 3] - through[k], x - through[k])) >= 0;
      if (is_inside) places[count++] = x;
    }
  };
  collect(a, b), collect(b, a);
  if (count < 2) return std::nullopt;
  std::array<Vec3, 2> ends = {places[0], places[0]};
  for (size_t i = 0; i < count; ++i) {
    for (size_t j = 0; j < i; ++j) {
      if (SquaredDistance(places[i], places[j]) > SquaredDistance(ends[0], ends[1])) ends = {places[j], places[i]};
    }
  }
  return ends;
}

Vec3 PlaceOfMeeting(const Vec3 (&a)[3], const Vec3 (&b)[3]) {
  const auto stretch = CommonStretch(a, b);
  return stretch ? 0.5 * ((*stretch)[0] + (*stretch)[1]) : (a[0] + a[1] + a[2]) / 3.0;
}

}  // namespace meshfront
