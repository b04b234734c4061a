#include "core/features/patch_width.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <memory>
#include <numbers>
#include <utility>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/core/features/crease_surfaces.h"
#include "tests/support/shapes.h"

namespace meshfront {
namespace {

using testing::CreasedSurfaceOf;
using ::testing::Each;
using ::testing::Field;
using ::testing::IsEmpty;
using ::testing::Not;

std::vector<WidthSample> WidthsOf(const MeshSurface& surface, double limit, int threads = 1, double least = 1e-6) {
  Context context;
  context.threads = threads;
  auto widths =
      MeasurePatchWidths(surface, std::vector<WidthRange>(surface.component_count(), {least, limit}), context);
  EXPECT_TRUE(widths.ok()) << widths.status();
  return *std::move(widths);
}

std::vector<WidthSample> WidthsOf(TriangleMesh mesh, double limit) {
  return WidthsOf(*CreasedSurfaceOf(std::move(mesh)), limit);
}

auto IsWide(double width) { return Field(&WidthSample::width, ::testing::DoubleNear(width, 1e-12)); }

// [-1, 1] along x, `width` along y.
TriangleMesh Ribbon(int n, double width) {
  return testing::Mapped(testing::Sheet(n), [&](const Vec3& p) { return Vec3{p.x, 0.5 * width * p.y, p.z}; });
}

// Of the samples that lie on the line y = `y`, the largest distance from one to the next, along x from -1 to 1.
double LargestGapAlong(const std::vector<WidthSample>& widths, double y) {
  std::vector<double> along{-1, 1};
  for (const WidthSample& s : widths) {
    if (std::abs(s.position.y - y) < 1e-12) along.push_back(s.position.x);
  }
  std::sort(along.begin(), along.end());
  double gap = 0;
  for (size_t i = 1; i < along.size(); ++i) gap = std::max(gap, along[i] - along[i - 1]);
  return gap;
}

TEST(PatchWidth, IsNoneWithoutRimsAndCreases) { EXPECT_THAT(WidthsOf(testing::Icosphere(3), 10), IsEmpty()); }

TEST(PatchWidth, IsMeasuredAcrossAnOpenRibbon) {
  for (const int n : {1, 2, 9}) {
    const std::vector<WidthSample> widths = WidthsOf(Ribbon(n, 0.1), 1);
    ASSERT_THAT(widths, Not(IsEmpty()));
    EXPECT_THAT(widths, Each(IsWide(0.1))) << n;
  }
}

TEST(PatchWidth, IsMeasuredAllAlongAnEdgeHoweverLongItIs) {
  // Two triangles, 2 by 0.02: samples at most a few widths apart. At the very ends the short side is near.
  const std::vector<WidthSample> widths = WidthsOf(Ribbon(1, 0.02), 1);
  for (const double y : {-0.01, 0.01}) EXPECT_LE(LargestGapAlong(widths, y), 5 * 0.02);
  double stretch = 0;
  for (const WidthSample& s : widths) stretch += s.stretch;
  EXPECT_LE(stretch, 2 * 2 + 1e-9);
  EXPECT_GT(stretch, 2 * 2 - 10 * 0.02) << "all of both long sides";
}

TEST(PatchWidth, IsNoneBeyondTheLimit) { EXPECT_THAT(WidthsOf(Ribbon(4, 0.1), 0.09), IsEmpty()); }

TEST(PatchWidth, IsNoneBelowTheLeast) {
  const auto ribbon = CreasedSurfaceOf(Ribbon(4, 0.1));
  EXPECT_THAT(WidthsOf(*ribbon, 1, 1, 0.11), IsEmpty());
  EXPECT_THAT(WidthsOf(*ribbon, 1, 1, 0.09), Not(IsEmpty()));
}

TEST(PatchWidth, FollowsTheSurfaceOverItsFolds) {
  // A ribbon rolled up along its width: an arc of two radians in eight chords.
  const TriangleMesh flat = testing::Sheet(8);
  const TriangleMesh rolled = testing::Mapped(flat, [](const Vec3& p) {
    return Vec3{20 * p.x, std::sin(p.y), std::cos(p.y)};
  });
  const double chords = 8 * 2 * std::sin(0.125);
  const std::vector<WidthSample> widths = WidthsOf(rolled, 3);
  ASSERT_THAT(widths, Not(IsEmpty()));
  EXPECT_THAT(widths, Each(IsWide(chords)));
}

TEST(PatchWidth, IsMeasuredOnBothSidesOfACrease) {
  // A plate 2 × 2 × 0.02: only its walls are narrow, seen from above and from below.
  const std::vector<WidthSample> widths = WidthsOf(testing::Extruded(testing::Sheet(4), 0.02), 0.5);
  ASSERT_THAT(widths, Not(IsEmpty()));
  EXPECT_THAT(widths, Each(IsWide(0.02)));
  for (const double z : {0.0, 0.02}) {
    EXPECT_TRUE(std::any_of(widths.begin(), widths.end(), [&](const auto& s) { return s.position.z == z; })) << z;
  }
}

TEST(PatchWidth, IsThatOfARingRoundAHole) {
  // Rims that share no node, all around: a wall 0.1 high around a hole of radius 0.4.
  const std::vector<WidthSample> widths = WidthsOf(testing::PlateWithRoundHole(24, 0.4, 0.1), 0.15);
  ASSERT_THAT(widths, Not(IsEmpty()));
  const auto is_at_hole = [](const WidthSample& s) { return std::hypot(s.position.x, s.position.y) < 0.45; };
  EXPECT_TRUE(std::any_of(widths.begin(), widths.end(), is_at_hole));
  EXPECT_THAT(widths, Each(Field(&WidthSample::width, ::testing::DoubleNear(0.1, 1e-3))));
}

TEST(PatchWidth, IsNoneAtCornersAndInRoundPatches) {
  const auto near_corner = [](double angle) {
    std::vector<WidthSample> widths = WidthsOf(testing::Wedge(angle, 8), 1.9);
    std::erase_if(widths, [](const WidthSample& s) { return std::hypot(s.position.x, s.position.y) > 1; });
    return widths;
  };
  EXPECT_THAT(near_corner(std::numbers::pi / 4), IsEmpty());
  EXPECT_THAT(near_corner(std::numbers::pi / 18), IsEmpty());
  EXPECT_THAT(near_corner(std::numbers::pi / 90), Not(IsEmpty())) << "2° are a strip that ends";
  EXPECT_THAT(WidthsOf(testing::CappedCylinder(1, 20, 48, 40), 3), IsEmpty()) << "caps 2 wide";
  EXPECT_THAT(WidthsOf(testing::Cube(4), 3), IsEmpty());
}

TEST(PatchWidth, IsThatOfAStripThatTapersToABluntEnd) {
  // From 0.5 to 0.1 wide over a length of 4, an angle of 6°. Far from the end it could be a wedge, and beside the end the end is near.
  const TriangleMesh tapered = testing::Mapped(testing::Sheet(16), [](const Vec3& p) {
    return Vec3{2 * p.x, (0.15 - 0.1 * p.x) * p.y, 0};
  });
  double narrowest = 1;
  for (const WidthSample& s : WidthsOf(tapered, 0.3)) {
    EXPECT_NEAR(s.width, 2 * std::abs(s.position.y), 0.1 * s.width);
    narrowest = std::min(narrowest, s.width);
  }
  EXPECT_LT(narrowest, 0.2);
}

TEST(PatchWidth, IsTheSameAtAnyNumberOfThreads) {
  const auto surface = CreasedSurfaceOf(testing::PlateWithRoundHole(24, 0.4, 0.1));
  const std::vector<WidthSample> one = WidthsOf(*surface, 0.5);
  for (const int threads : {2, 4}) {
    const std::vector<WidthSample> many = WidthsOf(*surface, 0.5, threads);
    ASSERT_EQ(many.size(), one.size());
    for (size_t i = 0; i < one.size(); ++i) {
      EXPECT_EQ(many[i].position, one[i].position);
      EXPECT_EQ(many[i].width, one[i].width);
      EXPECT_EQ(many[i].half_edge, one[i].half_edge);
    }
  }
}

TEST(PatchWidth, StopsWhenItIsToldTo) {
  const auto surface = CreasedSurfaceOf(Ribbon(4, 0.1));
  std::atomic<bool> stop{true};
  Context context;
  context.stop = &stop;
  EXPECT_EQ(MeasurePatchWidths(*surface, {{1e-3, 1}}, context).status().code(), absl::StatusCode::kCancelled);
}

}  // namespace
}  // namespace meshfront
