// The other side of a sheet, compared with a search through all samples.
#include "core/surface/opposed_samples.h"

#include <algorithm>
#include <limits>
#include <memory>

#include "core/surface/tolerances.h"
#include "gtest/gtest.h"
#include "tests/support/matchers.h"
#include "tests/support/shapes.h"

namespace meshfront::testing {
namespace {

TEST(OpposedSamples, AreTheNearestOfAllThatFaceTheOtherWay) {
  for (const TriangleMesh& shape : {ThinSlab(), Torus(1, 0.4, 60, 24), TwoSpheres(3)}) {
    const TriangleMesh points = Sampled(shape, 2000);
    const auto samples = MlsSamples::Create(points.positions, points.normals, 4, {});
    ASSERT_THAT(samples, IsOk());
    const OpposedSamples opposed(**samples);
    const auto all = (*samples)->samples();
    for (uint32_t i = 0; i < all.size(); i += 7) {
      double nearest = std::numeric_limits<double>::infinity();
      for (uint32_t j = 0; j < all.size(); ++j) {
        if ((*samples)->ComponentOf(j) == MlsSamples::kStray) continue;
        if (Dot(all[i].normal, all[j].normal) < surface_tolerances::kOpposed)
          nearest = std::min(nearest, Distance(all[i].position, all[j].position));
      }
      ASSERT_LT(nearest, 9);
      EXPECT_EQ(opposed.DistanceFrom(i, 9), nearest);
      EXPECT_EQ(opposed.DistanceFrom(i, 0.99 * nearest), std::numeric_limits<double>::infinity());
    }
  }
}

TEST(OpposedSamples, AreNowhereOnASheet) {
  const TriangleMesh points = Sampled(Sheet(4), 1000);
  const auto samples = MlsSamples::Create(points.positions, points.normals, 4, {});
  ASSERT_THAT(samples, IsOk());
  EXPECT_EQ(OpposedSamples(**samples).DistanceFrom(5, 100), std::numeric_limits<double>::infinity());
}

}  // namespace
}  // namespace meshfront::testing
