// The differentiation type against central differences and against surfaces whose curvature is known.
#include "core/geometry/jet.h"

#include <cmath>
#include <functional>

#include "gtest/gtest.h"

namespace meshfront {
namespace {

template <int kOrder>
Jet<kOrder> Formula(const Vec3& place) {
  const auto [x, y, z] = JetVariables<kOrder>(place);
  const Jet<kOrder> u = 2.0 - SquaredDistanceToPlace<kOrder>(place, {0.3, -0.2, 0.5});
  return FourthPower(u) * Sqrt(x * x + 2.0 * (y * y) + z * z) / (x * y - z * z - 7.0) + Reciprocal(z - 3.0);
}

double Value(const Vec3& place) { return Formula<1>(place).value(); }

Vec3 Unit(int axis) { return {axis == 0 ? 1.0 : 0.0, axis == 1 ? 1.0 : 0.0, axis == 2 ? 1.0 : 0.0}; }

TEST(Jet, AgreesWithCentralDifferences) {
  const Vec3 p{0.4, 0.7, -0.6};
  const Jet<2> f = Formula<2>(p);
  EXPECT_DOUBLE_EQ(f.value(), Value(p));
  constexpr double h = 1e-5, k = 1e-3;
  for (int i = 0; i < 3; ++i) {
    const double slope = (Value(p + h * Unit(i)) - Value(p - h * Unit(i))) / (2 * h);
    EXPECT_NEAR(f.Gradient()[i], slope, 1e-8 * std::abs(slope) + 1e-8);
    for (int j = 0; j < 3; ++j) {
      const Vec3 a = k * Unit(i), b = k * Unit(j);
      const double bend = (Value(p + a + b) - Value(p + a - b) - Value(p - a + b) + Value(p - a - b)) / (4 * k * k);
      EXPECT_NEAR(f.HessianTimes(Unit(i))[j], bend, 1e-4 * std::abs(bend) + 1e-4);
    }
  }
}

TEST(Jet, HasTheSameGradientAtEitherOrder) {
  const Vec3 p{-0.3, 0.2, 0.9};
  EXPECT_EQ(Formula<1>(p).Gradient(), Formula<2>(p).Gradient());
}

TEST(Jet, MultipliesOutTheSquaredDistance) {
  const Vec3 p{0.1, 2, -1}, q{4, 0.5, 3};
  auto d = JetVariables<2>(p);
  for (int i = 0; i < 3; ++i) d[i] = d[i] - q[i];
  const Jet<2> product = Dot(d, d), direct = SquaredDistanceToPlace<2>(p, q);
  for (int i = 0; i < Jet<2>::kSize; ++i) EXPECT_DOUBLE_EQ(product.v[i], direct.v[i]) << i;
}

TEST(PrincipalCurvatures, AreThoseOfASphereWhereverTheFunctionIsScaled) {
  const auto [x, y, z] = JetVariables<2>({1, -2, 2});
  for (const Jet<2>& f : {x * x + y * y + z * z - 9.0, 5.0 * Sqrt(x * x + y * y + z * z)}) {
    EXPECT_NEAR(PrincipalCurvatures(f)[0], 1.0 / 3, 1e-12);
    EXPECT_NEAR(PrincipalCurvatures(f)[1], 1.0 / 3, 1e-12);
  }
}

// Radii 2 and 0.5: on the inner circle the curvatures are −1 / 1.5 and 1 / 0.5, on the outer 1 / 2.5 and 1 / 0.5.
TEST(PrincipalCurvatures, AreThoseOfATorus) {
  for (const auto& [place, low] : {std::pair{Vec3{1.5, 0, 0}, -1 / 1.5}, {Vec3{2.5, 0, 0}, 1 / 2.5}}) {
    const auto [x, y, z] = JetVariables<2>(place);
    const Jet<2> around = Sqrt(x * x + y * y) - 2.0;
    const auto curvatures = PrincipalCurvatures(around * around + z * z - 0.25);
    EXPECT_NEAR(curvatures[0], low, 1e-12);
    EXPECT_NEAR(curvatures[1], 2, 1e-12);
  }
}

TEST(PrincipalCurvatures, AreZeroWithoutAGradient) {
  EXPECT_EQ(PrincipalCurvatures(Jet<2>{}), (std::array<double, 2>{0, 0}));
}

TEST(Jet, SumsInLanesHaveTheBitsOfSums) {
  Jet<2> sum;
  JetLanes<2> lanes;
  for (int i = 1; i < 40; ++i) {
    const auto [x, y, z] = JetVariables<2>({1.0 / i, 0.3 * i, 2.0 - 0.1 * i});
    const Jet<2> term = FourthPower(x * y - z);
    AddScaled(sum, 1.0 / (3 * i), term);
    lanes.AddScaled(1.0 / (3 * i), JetLanes<2>::Of(term));
  }
  for (int i = 0; i < Jet<2>::kSize; ++i) EXPECT_EQ(lanes.Get().v[i], sum.v[i]) << i;
}

}  // namespace
}  // namespace meshfront
