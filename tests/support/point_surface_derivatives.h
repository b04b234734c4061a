// Whether the exact derivatives of a point surface's function are those that finite differences tell.
#pragma once

#include <cstdint>

#include "core/surface/point_surface.h"
#include "gtest/gtest.h"

namespace meshfront::testing {

struct DerivativeCheck {
  double step;                 // of the differences
  double height;               // above every 397th sample, in supports
  double gradient, curvature;  // allowed: of the gradient, and of the Hessian's columns relative to 1 + their length
};

template <class Surface>
void ExpectDerivativesOfValue(const Surface& surface, const DerivativeCheck& check) {
  const double h = check.step;
  for (uint32_t i = 0; i < surface.samples().samples().size(); i += 397) {
    const MlsSample& s = surface.samples().samples()[i];
    const Vec3 x = s.position + check.height * s.support * s.normal;
    const uint32_t patch = surface.samples().PatchOf(i);
    const Jet<2> f = surface.template Evaluate<2>(x, patch).f;
    for (int axis = 0; axis < 3; ++axis) {
      Vec3 step;
      step[axis] = h;
      const auto after = surface.template Evaluate<1>(x + step, patch);
      const auto before = surface.template Evaluate<1>(x - step, patch);
      EXPECT_NEAR(f.Gradient()[axis], (after.f.value() - before.f.value()) / (2 * h), check.gradient);
      Vec3 unit;
      unit[axis] = 1;
      const Vec3 bend = (after.f.Gradient() - before.f.Gradient()) / (2 * h);
      EXPECT_LE(Distance(f.HessianTimes(unit), bend), check.curvature * (1 + Norm(bend)));
    }
  }
}

}  // namespace meshfront::testing
