// Winding numbers of closed, overlapping and open meshes.
#include "core/mesh/winding_number.h"

#include <algorithm>
#include <cmath>

#include "gtest/gtest.h"
#include "tests/support/shapes.h"

namespace meshfront {
namespace {

TEST(WindingNumber, IsOneInsideAndZeroOutside) {
  const TriangleMesh torus = testing::Torus(1, 0.4, 60, 24);
  const WindingNumber winding(torus);
  for (double angle = 0; angle < 6; angle += 0.31) {
    const Vec3 out{std::cos(angle), std::sin(angle), 0};
    for (const double r : {0.7, 0.99, 1.38}) EXPECT_NEAR(winding.At(r * out), 1, 0.06);
    for (const double r : {0.0, 0.55, 1.42, 3.0, 100.0}) EXPECT_NEAR(winding.At(r * out), 0, 0.06);
  }
}

TEST(WindingNumber, CountsPartsThatOverlapAndCavities) {
  const TriangleMesh two = testing::Joined(testing::Icosphere(3), testing::Moved(testing::Icosphere(3), {1, 0, 0}));
  EXPECT_NEAR(WindingNumber(two).At({0.5, 0.1, 0}), 2, 0.06);
  EXPECT_NEAR(WindingNumber(two).At({-0.5, 0.1, 0}), 1, 0.06);
  EXPECT_NEAR(WindingNumber(testing::ConcentricShells(3, 0.5)).At({0.1, 0.1, 0}), 0, 0.06);
}

TEST(WindingNumber, IsAPartOfOneBesideAnOpenMesh) {
  const TriangleMesh half = testing::Hemisphere(4);
  EXPECT_NEAR(WindingNumber(half).At({0, 0, 0}), 0.5, 0.02);
  EXPECT_GT(WindingNumber(half).At({0, 0, 0.95}), 0.8);
  EXPECT_NEAR(WindingNumber(half).At({0, 0, 1.02}), 0, 0.2);
}

// A fine ball and a coarse one around a part of it, whose faces are of very different sizes: the quick answer is the careful one.
TEST(WindingNumber, TellsQuicklyWhatIsAboveAThreshold) {
  const TriangleMesh mesh =
      testing::Joined(testing::Icosphere(5), testing::Moved(testing::Scaled(testing::Icosphere(1), 2), {1.5, 0, 0}));
  const WindingNumber winding(mesh);
  int above = 0, below = 0;
  for (double x = -2; x <= 4; x += 0.21) {
    for (double y = -2; y <= 2; y += 0.23) {
      for (const double threshold : {0.7, 1.5}) {
        const Vec3 place{x, y, 0.05};
        EXPECT_EQ(winding.IsAbove(place, threshold), winding.At(place) > threshold) << x << " " << y;
        ++(winding.At(place) > threshold ? above : below);
      }
    }
  }
  EXPECT_GT(std::min(above, below), 100);
}

}  // namespace
}  // namespace meshfront
