// A surface that core knows nothing of, from its formula to a mesh ("How to add a surface" in core/README.md).
#include "tests/support/formula_surface.h"

#include <cmath>
#include <random>

#include "core/front/advancing_front.h"
#include "core/guidance/sizing.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/support/checking_sink.h"
#include "tests/support/matchers.h"

namespace meshfront::testing {
namespace {

constexpr double kRho = 0.8, kEta = 1.2;

// Ideal lengths at places all over the surface, which lies within a box around the origin.
GuidanceField FieldOf(const Surface& surface, const Vec3& half) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> unit(-1, 1);
  std::vector<SizingSample> samples;
  for (int i = 0; i < 4000; ++i) {
    const SourcePoint p = surface.Snap({}, {half.x * unit(random), half.y * unit(random), half.z * unit(random)});
    if (IsFinite(p.position)) samples.push_back({p.position, IdealLength(kRho, surface.MaxCurvatureAt(p))});
  }
  return *GuidanceField::Create(samples, {kEta, 0.01, 0.5}, {});
}

void ExpectMeshOf(const FormulaSurface& surface, const Vec3& half, int genus) {
  const GuidanceField field = FieldOf(surface, half);
  CheckingSink sink;
  const auto report = AdvanceFront(surface, field, {}, {surface.Snap({}, {half.x, 0.1, 0.1})},
                                   {.fit = false, .error_per_length = ErrorPerLength(kRho)}, sink, {});
  ASSERT_THAT(report, IsOk());
  sink.CheckEnd();
  EXPECT_TRUE(sink.complaints().empty());
  EXPECT_THAT(sink.mesh(), IsClosedManifold());
  EXPECT_THAT(sink.mesh(), HasGenus(genus));
  EXPECT_THAT(sink.mesh(), HasNoSelfIntersection());
  EXPECT_GE(report->quality.radius_ratio_p0_5, 0.8);
  for (const Vec3& x : sink.mesh().positions) {
    const Jet<2> f = surface.ValueAt(x);
    EXPECT_LE(std::abs(f.value()), 1e-8 * Norm(f.Gradient()));
  }
}

TEST(AdvanceFrontOnAFormula, MeshesATorus) { ExpectMeshOf(FormulaSurface(TorusFormula), {1.4, 1.4, 0.4}, 1); }

TEST(AdvanceFrontOnAFormula, MeshesTwoBallsMeltedIntoOne) {
  ExpectMeshOf(FormulaSurface(BlendFormula), {1.8, 0.8, 0.8}, 0);
}

}  // namespace
}  // namespace meshfront::testing
