// Surfaces given by a formula f(x, y, z) = 0: the shortest whole example of a Surface ("How to add a surface" in
// core/README.md).
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <optional>
#include <utility>

#include "core/geometry/jet.h"
#include "core/surface/surface.h"

namespace meshfront::testing {

// f in the arithmetic of jets, growing outward, with a gradient at its zero set; no other sheet of it nearer than the
// edges of the fronts are long. Everything is Newton's method.
class FormulaSurface : public Surface {
 public:
  using Formula = std::function<Jet<2>(const std::array<Jet<2>, 3>& x)>;
  explicit FormulaSurface(Formula f) : f_(std::move(f)) {}

  Jet<2> ValueAt(const Vec3& x) const { return f_(JetVariables<2>(x)); }

  SourcePoint Snap(const SourcePoint&, const Vec3& target) const override {
    Vec3 x = target;
    for (int round = 0; round < 50; ++round) {
      const Vec3 before = x;
      for (int step = 0; step < 8; ++step) {
        const Jet<2> f = ValueAt(x);
        x -= (f.value() / SquaredNorm(f.Gradient())) * f.Gradient();
      }
      const Vec3 normal = Normalized(ValueAt(x).Gradient()), rest = target - x,
                 beside = rest - Dot(rest, normal) * normal;
      if (Norm(beside) <= 1e-9 * Norm(rest) || Distance(x, target) <= 1e-14 || Distance(x, before) <= 1e-13) break;
      x += beside;
    }
    return {x, Normalized(ValueAt(x).Gradient()), 0};
  }

  // On the circle in which the spheres meet, from where the surface's tangent plane goes on.
  std::optional<SourcePoint> FindApex(const SourcePoint& a, const SourcePoint& b, double radius_a,
                                      double radius_b) const override {
    const Vec3 ab = b.position - a.position, normal = Normalized(a.normal + b.normal);
    const double base = Norm(ab);
    if (!(base > 0)) return std::nullopt;
    const double along = 0.5 * (base + (radius_a - radius_b) * (radius_a + radius_b) / base);
    const double square = radius_a * radius_a - along * along;
    if (!(square > 0)) return std::nullopt;
    const Vec3 axis = ab / base, open = Normalized(Cross(axis, normal)), up = Cross(open, axis);
    const Vec3 center = a.position + along * axis;
    double angle = 0;
    for (int step = 0; step < 30; ++step) {
      const Vec3 out = std::cos(angle) * open + std::sin(angle) * up, x = center + std::sqrt(square) * out;
      const Jet<2> f = ValueAt(x);
      const Vec3 across = std::sqrt(square) * (std::cos(angle) * up - std::sin(angle) * open);
      const double move = std::clamp(-f.value() / Dot(f.Gradient(), across), -0.3, 0.3);
      if (!(std::cos(angle) > 0.2)) return std::nullopt;  // steeper than 78° against the front
      if (std::abs(move) > 1e-12) {
        angle += move;
        continue;
      }
      const SourcePoint found{x, Normalized(f.Gradient()), 0};
      if (Dot(found.normal, across) <= 0) return std::nullopt;  // seen from behind: another sheet
      return found;
    }
    return std::nullopt;
  }

  double MaxCurvatureAt(const SourcePoint& p) const override {
    const auto [low, high] = PrincipalCurvatures(ValueAt(p.position));
    return std::max(std::abs(low), std::abs(high));
  }
  bool IsOnBoundary(const SourcePoint&) const override { return false; }

 private:
  Formula f_;
};

inline Jet<2> SquaredDistanceTo(const std::array<Jet<2>, 3>& x, const Vec3& p) {
  const std::array<Jet<2>, 3> d = {x[0] - p.x, x[1] - p.y, x[2] - p.z};
  return Dot(d, d);
}

// A tube of radius 0.4 around a circle of radius 1.
inline Jet<2> TorusFormula(const std::array<Jet<2>, 3>& x) {
  const Jet<2> across = Sqrt(x[0] * x[0] + x[1] * x[1]) - 1.0;
  return Sqrt(across * across + x[2] * x[2]) - 0.4;
}

// Where two unit charges at x = ±1 make a potential of 1.9: two balls melted into one, with a saddle between them.
inline Jet<2> BlendFormula(const std::array<Jet<2>, 3>& x) {
  return 1.9 - (Reciprocal(Sqrt(SquaredDistanceTo(x, {1, 0, 0}))) + Reciprocal(Sqrt(SquaredDistanceTo(x, {-1, 0, 0}))));
}

}  // namespace meshfront::testing
