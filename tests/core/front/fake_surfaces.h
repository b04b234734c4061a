// Surfaces by formula, exact to rounding: what the front is tested on, so that no mesh and no walk can be to blame.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <optional>

#include "core/surface/surface.h"

namespace meshfront::testing {

// A surface given by its signed distance (positive outside) and normal. Places the apex by walking both ways around the circle
// in which the spheres meet, from the tangent plane's side, until the signed distance changes its sign.
class DistanceSurface : public Surface {
 public:
  // The closest place to x on the sheet that `patch` names.
  virtual SourcePoint Project(const Vec3& x, uint32_t patch) const = 0;
  virtual double SignedDistance(const Vec3& x, uint32_t patch) const = 0;
  virtual bool Contains(const Vec3&) const { return true; }  // false: beyond the rim
  double MaxCurvatureAt(const SourcePoint&) const override { return 0; }
  bool IsOnBoundary(const SourcePoint&) const override { return false; }

  SourcePoint Snap(const SourcePoint& start, const Vec3& target) const override { return Project(target, start.patch); }

  std::optional<SourcePoint> FindApex(const SourcePoint& a, const SourcePoint& b, double radius_a,
                                      double radius_b) const override {
    const Vec3 ab = b.position - a.position;
    const double d = Norm(ab), along = (d * d + radius_a * radius_a - radius_b * radius_b) / (2 * d);
    const double square = radius_a * radius_a - along * along;
    if (!(square > 0)) return std::nullopt;
    const Vec3 axis = ab / d, middle = a.position + along * axis;
    const Vec3 u = Normalized(Cross(axis, a.normal + b.normal)), w = Cross(u, axis);
    const auto at = [&](double angle) {
      return middle + std::sqrt(square) * (std::cos(angle) * u + std::sin(angle) * w);
    };
    const auto f = [&](double angle) { return SignedDistance(at(angle), a.patch); };
    constexpr int kSteps = 32;
    for (int i = 0; i < kSteps; ++i) {
      for (const double sign : {1.0, -1.0}) {
        double low = sign * i * std::numbers::pi / (2 * kSteps),
               high = sign * (i + 1) * std::numbers::pi / (2 * kSteps);
        if ((f(low) > 0) == (f(high) > 0)) continue;
        const bool rising = f(high) > 0;
        for (int step = 0; step < 60; ++step) {
          const double angle = 0.5 * (low + high);
          ((f(angle) > 0) == rising ? high : low) = angle;
        }
        SourcePoint x = Project(at(low), a.patch);
        if (!Contains(x.position)) return std::nullopt;
        x.position = at(low);
        return x;
      }
    }
    return std::nullopt;
  }
};

// z = 0 within a circle (and outside a round hole), facing up.
class PlaneSurface : public DistanceSurface {
 public:
  explicit PlaneSurface(double radius = 1e30, double hole_radius = 0, Vec3 hole = {})
      : radius_(radius), hole_radius_(hole_radius), hole_(hole) {}
  SourcePoint Project(const Vec3& x, uint32_t) const override {
    Vec3 p{x.x, x.y, 0};
    if (Norm(p) > radius_) p = radius_ * Normalized(p);
    if (Distance(p, hole_) < hole_radius_) p = hole_ + hole_radius_ * Normalized(p - hole_);
    return {p, {0, 0, 1}, 0};
  }
  double SignedDistance(const Vec3& x, uint32_t) const override { return x.z; }
  bool Contains(const Vec3& x) const override { return Norm(x) <= radius_ && Distance(x, hole_) >= hole_radius_; }
  bool IsOnBoundary(const SourcePoint& p) const override {
    return std::abs(Norm(p.position) - radius_) < 1e-9 || std::abs(Distance(p.position, hole_) - hole_radius_) < 1e-9;
  }

 private:
  double radius_, hole_radius_;
  Vec3 hole_;
};

// z = patch · gap: sheets that lie on each other, facing up.
class SheetsSurface : public DistanceSurface {
 public:
  explicit SheetsSurface(double gap) : gap_(gap) {}
  SourcePoint Project(const Vec3& x, uint32_t patch) const override {
    return {{x.x, x.y, patch * gap_}, {0, 0, 1}, patch};
  }
  double SignedDistance(const Vec3& x, uint32_t patch) const override { return x.z - patch * gap_; }

 private:
  double gap_;
};

// Spheres of one radius around (4 · patch · radius, 0, 0).
class SphereSurface : public DistanceSurface {
 public:
  explicit SphereSurface(double radius = 1) : radius_(radius) {}
  Vec3 CenterOf(uint32_t patch) const { return {4 * patch * radius_, 0, 0}; }
  SourcePoint Project(const Vec3& x, uint32_t patch) const override {
    const Vec3 n = Normalized(x - CenterOf(patch));
    return {CenterOf(patch) + radius_ * n, n, patch};
  }
  double SignedDistance(const Vec3& x, uint32_t patch) const override { return Norm(x - CenterOf(patch)) - radius_; }
  double MaxCurvatureAt(const SourcePoint&) const override { return 1 / radius_; }

 private:
  double radius_;
};

// An endless tube around the z axis.
class CylinderSurface : public DistanceSurface {
 public:
  explicit CylinderSurface(double radius) : radius_(radius) {}
  SourcePoint Project(const Vec3& x, uint32_t) const override {
    Vec3 n = Normalized(Vec3{x.x, x.y, 0});
    if (n == Vec3{}) n = {1, 0, 0};
    return {Vec3{0, 0, x.z} + radius_ * n, n, 0};
  }
  double SignedDistance(const Vec3& x, uint32_t) const override { return std::hypot(x.x, x.y) - radius_; }
  double MaxCurvatureAt(const SourcePoint&) const override { return 1 / radius_; }

 private:
  double radius_;
};

// A tube around a circle in the xy plane.
class TorusSurface : public DistanceSurface {
 public:
  TorusSurface(double major, double minor) : major_(major), minor_(minor) {}
  SourcePoint Project(const Vec3& x, uint32_t) const override {
    const Vec3 core = major_ * Normalized(Vec3{x.x, x.y, 0}), n = Normalized(x - core);
    return {core + minor_ * n, n, 0};
  }
  double SignedDistance(const Vec3& x, uint32_t) const override {
    return std::hypot(std::hypot(x.x, x.y) - major_, x.z) - minor_;
  }
  double MaxCurvatureAt(const SourcePoint& p) const override {
    return std::max(1 / minor_, std::abs((std::hypot(p.position.x, p.position.y) - major_) / minor_ /
                                         std::hypot(p.position.x, p.position.y)));
  }

 private:
  double major_, minor_;
};

}  // namespace meshfront::testing
