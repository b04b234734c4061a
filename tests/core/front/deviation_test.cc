#include "core/front/deviation.h"

#include <cmath>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/core/front/fake_surfaces.h"

namespace meshfront {
namespace {

using meshfront::testing::DistanceSurface;
using meshfront::testing::PlaneSurface;
using meshfront::testing::SphereSurface;

std::array<PlaceAndFoot, 3> Inscribed(const Surface& surface, double radius, double x = 0, double y = 0) {
  std::array<PlaceAndFoot, 3> corners;
  for (int i = 0; i < 3; ++i) {
    const double angle = 2 * i * 3.141592653589793 / 3;
    const Vec3 place{x + radius * std::cos(angle), y + radius * std::sin(angle), 1};
    const SourcePoint foot = surface.Snap({}, place);
    corners[i] = {foot.position, foot};
  }
  return corners;
}

// An equilateral triangle inscribed in the unit sphere with circumradius r is off by 1 − √(1 − r²) in its middle.
TEST(Deviation, OfATriangleInASphereIsThatOfItsMiddle) {
  const SphereSurface sphere;
  SourcePoint start;
  start.patch = 0;
  for (const double radius : {0.05, 0.2, 0.5}) {
    std::array<PlaceAndFoot, 3> corners;
    for (int i = 0; i < 3; ++i) {
      const double angle = 2 * i * 3.141592653589793 / 3;
      const Vec3 place{radius * std::cos(angle), radius * std::sin(angle), std::sqrt(1 - radius * radius)};
      corners[i] = {place, sphere.Project(place, 0)};
    }
    const double exact = 1 - std::sqrt(1 - radius * radius);
    EXPECT_TRUE(DeviationMeter(sphere, 1.02 * exact).Measure(corners).is_kept) << radius;
    const Deviation beyond = DeviationMeter(sphere, 0.98 * exact).Measure(corners);
    EXPECT_FALSE(beyond.is_kept) << radius;
    EXPECT_GT(beyond.largest, 0.98 * exact);
    EXPECT_LE(beyond.largest, exact * (1 + 1e-9));
    EXPECT_NEAR(beyond.worst.Gap(), beyond.largest, 1e-15);
    EXPECT_LT(std::hypot(beyond.worst.place.x, beyond.worst.place.y), 0.6 * radius) << "near the middle";
  }
}

// A triangle inscribed in a sphere, whose centroid is off by as much as it is high, and the middles of its sides by three quarters.
std::array<PlaceAndFoot, 3> InscribedOnTop(const SphereSurface& sphere, double radius) {
  std::array<PlaceAndFoot, 3> corners;
  for (int i = 0; i < 3; ++i) {
    const double angle = 2 * i * 3.141592653589793 / 3;
    const Vec3 place{radius * std::cos(angle), radius * std::sin(angle), std::sqrt(1 - radius * radius)};
    corners[i] = {place, sphere.Project(place, 0)};
  }
  return corners;
}

// What is off by half of the bound needs no measure, what is off by two thirds or turns away does, walked to or told.
TEST(Deviation, SeemsSmallWherePlacesAreNearAndNormalsAgree) {
  const SphereSurface sphere;
  const std::array<PlaceAndFoot, 3> flat = InscribedOnTop(sphere, 0.2), bent = InscribedOnTop(sphere, 0.9);
  const double off = 1 - std::sqrt(1 - 0.2 * 0.2);
  const Vec3 top{0, 0, 1}, far_top{0, 0, 1 + 2 * off};
  const DeviationMeter wide(sphere, 2 * off), narrow(sphere, 1.5 * off), huge(sphere, 10);
  for (const Vec3* foot : {static_cast<const Vec3*>(nullptr), &top}) {
    EXPECT_TRUE(wide.SeemsNear(flat, foot));
    EXPECT_FALSE(narrow.SeemsNear(flat, foot));
    EXPECT_FALSE(huge.SeemsNear(bent, foot)) << "64° between the triangle and the sphere at its corners";
  }
  EXPECT_FALSE(wide.SeemsNear(flat, &far_top));
}

// A sphere that has a bump over one side of the triangle.
class BumpySphere : public SphereSurface {
 public:
  mutable int asked = 0;
  SourcePoint Foot(const SourcePoint& start, const Vec3& target) const override {
    ++asked;
    SourcePoint foot = Snap(start, target);
    if (target.y > 0.05) foot.position += 0.1 * foot.normal;
    return foot;
  }
};

// The middle of the side over which normals bend most is looked at, unless all is so near that it needs no look.
TEST(Deviation, LooksAtTheMiddleOfASideWhereItMayBeFar) {
  const BumpySphere sphere;
  const std::array<PlaceAndFoot, 3> corners = InscribedOnTop(sphere, 0.2);
  const double off = 1 - std::sqrt(1 - 0.2 * 0.2);
  const Vec3 top{0, 0, 1};
  EXPECT_TRUE(DeviationMeter(sphere, 4 * off).SeemsNear(corners, &top));
  EXPECT_EQ(sphere.asked, 0);
  for (const int side : {0, 1}) {  // the bump is over the first
    std::array<PlaceAndFoot, 3> bent = corners;
    for (const int end : {side, side + 1}) {
      const Vec3 outwards{corners[end].place.x, corners[end].place.y, 0};
      bent[end].foot.normal = Normalized(bent[end].foot.normal + 0.1 * outwards);
    }
    sphere.asked = 0;
    EXPECT_EQ(DeviationMeter(sphere, 2 * off).SeemsNear(bent, &top), side == 1);
    EXPECT_EQ(sphere.asked, 1);
  }
}

TEST(Deviation, OfCornersCounts) {
  const PlaneSurface plane;
  std::array<PlaceAndFoot, 3> corners = Inscribed(plane, 1);
  EXPECT_TRUE(DeviationMeter(plane, 1e-12).Measure(corners).is_kept);
  corners[1].place.z = 0.1;
  EXPECT_FALSE(DeviationMeter(plane, 0.09).Measure(corners).is_kept);
  EXPECT_TRUE(DeviationMeter(plane, 0.11).Measure(corners).is_kept);
}

// The plane with a furrow along x = `at`, of depth and half width `size`: sides at 45°.
class FurrowSurface : public DistanceSurface {
 public:
  FurrowSurface(double at, double size) : at_(at), size_(size) {}
  SourcePoint Project(const Vec3& x, uint32_t) const override {
    const double d = x.x - at_, s = d < 0 ? -1 : 1;
    if (std::abs(d) >= size_ && x.z >= 0) return {{x.x, x.y, 0}, {0, 0, 1}, 0};
    // The nearer of the plane's edge and the slope z = |d| − size.
    const double along = std::clamp((std::abs(d) + x.z + size_) / 2, 0.0, size_);
    return {{at_ + s * along, x.y, along - size_}, Normalized(Vec3{-s, 0, 1}), 0};
  }
  double SignedDistance(const Vec3& x, uint32_t patch) const override {
    const SourcePoint foot = Project(x, patch);
    return Dot(x - foot.position, foot.normal);
  }

 private:
  double at_, size_;
};

// A furrow beside the middles of the sides, as wide as an eighth of a side at least: narrower ones only a surface with faces knows of.
TEST(Deviation, OfAFurrowBesideTheMiddlesIsFound) {
  constexpr double kWidth = 0.3;
  for (const double at : {-0.31, -0.1, 0.13, 0.3, 0.55}) {
    const FurrowSurface furrow(at, kWidth);
    const auto corners = Inscribed(PlaneSurface(), 1);
    const double exact = kWidth / std::sqrt(2.0);  // from above its bottom to either slope
    EXPECT_FALSE(DeviationMeter(furrow, 0.8 * exact).Measure(corners).is_kept) << at;
    EXPECT_TRUE(DeviationMeter(furrow, 1.05 * exact).Measure(corners).is_kept) << at;
  }
}

// The same of four pieces: the plane on either side, and the slopes.
class FurrowOfPieces : public FurrowSurface {
 public:
  FurrowOfPieces(double at, double size) : FurrowSurface(at, size), at_(at), size_(size) {}
  SourcePoint Project(const Vec3& x, uint32_t patch) const override {
    SourcePoint p = FurrowSurface::Project(x, patch);
    p.patch = (p.position.x < at_ ? 0 : 2) + (p.position.z < 0 ? 1 : 0);
    return p;
  }
  double DistanceToPieceOf(const SourcePoint& p, const Vec3& place) const override {
    const double side = p.patch < 2 ? -1 : 1, d = side * (place.x - at_);  // away from the bottom
    if (p.patch % 2 == 0) return std::hypot(place.z, std::max(0.0, size_ - d));
    const double along = std::clamp((d + place.z + size_) / 2, 0.0, size_);
    return std::hypot(d - along, place.z - (along - size_));
  }

 private:
  double at_, size_;
};

// However narrow: what can't be shown to keep the bound does not keep it.
TEST(Deviation, OfAFurrowBetweenPiecesIsAlwaysFound) {
  for (const double width : {0.001, 0.01, 0.1}) {
    for (const double at : {-0.31, 0.1234, 0.55}) {
      const FurrowOfPieces furrow(at, width);
      const auto corners = Inscribed(furrow, 1);
      const double exact = width / std::sqrt(2.0);
      EXPECT_FALSE(DeviationMeter(furrow, 0.8 * exact).Measure(corners).is_kept) << width << " at " << at;
      EXPECT_TRUE(DeviationMeter(furrow, 1.5 * exact).Measure(corners).is_kept || width < 0.05)
          << width << " at " << at;
    }
  }
}

}  // namespace
}  // namespace meshfront
