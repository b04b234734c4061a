#include "core/features/attribute_seams.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/geometry/triangle.h"
#include "tests/support/shapes.h"
#include "tests/support/textured.h"

namespace meshfront {
namespace {

struct Seams {
  std::vector<bool> flags;
  bool has_flat_normals = false;
  int64_t edges() const { return std::count(flags.begin(), flags.end(), true) / 2; }
};

Seams SeamsOf(const TriangleMesh& mesh) {
  Seams seams;
  seams.flags.resize(3 * mesh.triangles.size());
  seams.has_flat_normals = MarkAttributeSeams(mesh, CreateAdjacency(mesh), seams.flags);
  return seams;
}

std::vector<float> Flat(const Vec3& n) {
  return {static_cast<float>(n.x), static_cast<float>(n.y), static_cast<float>(n.z)};
}

// Down one meridian, also where it ends; not the other meridians at the poles, where each face has a value of its own.
TEST(MarkAttributeSeams, FollowsTheSeamOfAGlobe) {
  const TriangleMesh globe = testing::Textured(testing::UvSphere(24, 12), testing::AroundZ);
  const Seams seams = SeamsOf(globe);
  EXPECT_GE(seams.edges(), 11);
  EXPECT_LE(seams.edges(), 13);
  for (uint32_t h = 0; h < seams.flags.size(); ++h) {
    if (!seams.flags[h]) continue;
    EXPECT_NEAR(globe.PositionAt(OriginOf(globe, h)).y, 0, 1e-9);
    EXPECT_LT(globe.PositionAt(OriginOf(globe, h)).x, 1e-9);
  }
}

TEST(MarkAttributeSeams, SeesNoSeamInWhatOnlyRoundingParts) {
  const auto map = [](const Vec3& p, const Vec3& c) -> std::array<double, 2> { return {p.x + 1e-6 * c.y, p.y}; };
  EXPECT_EQ(SeamsOf(testing::Textured(testing::Sheet(8), map)).edges(), 0);
}

// A mouth that is shut: where two sides of an edge go different ways, not where their normals do, nor in the noise of a target that is
// small beside another one.
TEST(MarkAttributeSeams, FollowsLinesAlongWhichMorphTargetsTear) {
  const TriangleMesh sheet = testing::Sheet(8);
  const auto moved = [&](const std::string& name, float far, float near) {
    TriangleMesh mesh = testing::WithChannel(sheet, "MORPH_0_POSITION", 3, [&](const Vec3& p, const Vec3&) {
      return std::vector<float>{static_cast<float>(p.y), 0, 0};
    });
    const double middle = BoundingBox(sheet).Center().x;
    return testing::WithChannel(mesh, name, 3, [&](const Vec3&, const Vec3& centroid) {
      return std::vector<float>{0, 0, centroid.x > middle ? far : near};
    });
  };
  EXPECT_EQ(SeamsOf(moved("MORPH_1_POSITION", 0.5, -0.5)).edges(), 8);
  EXPECT_EQ(SeamsOf(moved("MORPH_1_POSITION", 1e-6f, -1e-6f)).edges(), 0);
  EXPECT_EQ(SeamsOf(moved("MORPH_1_NORMAL", 0.5, -0.5)).edges(), 0);
}

TEST(MarkAttributeSeams, FollowsBordersOfGroups) {
  TriangleMesh sheet = testing::Sheet(8);
  for (const Triangle& t : sheet.triangles) {
    const double x = sheet.PositionAt(t[0]).x + sheet.PositionAt(t[1]).x + sheet.PositionAt(t[2]).x;
    sheet.attributes.groups.push_back(x > 1.5 * BoundingBox(sheet).max.x ? 1 : 0);
  }
  EXPECT_EQ(SeamsOf(sheet).edges(), 8);
}

// The texture of the left half is that of the right one, seen from behind.
TEST(MarkAttributeSeams, FollowsTheMirrorOfATexture) {
  const double middle = BoundingBox(testing::Sheet(8)).Center().x;
  const auto map = [&](const Vec3& p, const Vec3&) -> std::array<double, 2> { return {std::abs(p.x - middle), p.y}; };
  EXPECT_EQ(SeamsOf(testing::Textured(testing::Sheet(8), map)).edges(), 8);
}

TEST(MarkAttributeSeams, FollowsHardNormalsButNotThoseOfFlatFaces) {
  const TriangleMesh roof = testing::HeightField(8, [](double, double y) { return -0.2 * std::abs(y); });
  const auto side = [](const Vec3&, const Vec3& c) { return Flat(Normalized(Vec3{0, c.y > 0 ? 0.2 : -0.2, 1})); };
  const Seams hard = SeamsOf(testing::WithChannel(roof, "NORMAL", 3, side));
  EXPECT_EQ(hard.edges(), 8);
  EXPECT_FALSE(hard.has_flat_normals);
  const auto radial = [](const Vec3&, const Vec3& c) { return Flat(Normalized(c)); };
  const Seams flat = SeamsOf(testing::WithChannel(testing::Icosphere(2), "NORMAL", 3, radial));
  EXPECT_EQ(flat.edges(), 0);
  EXPECT_TRUE(flat.has_flat_normals);
}

TEST(MarkAttributeSeams, MakesNoneOfSkinWeights) {
  const auto weights = [](const Vec3&, const Vec3& c) { return std::vector<float>(4, c.x > 0 ? 1.0f : 0.0f); };
  EXPECT_EQ(SeamsOf(testing::WithChannel(testing::Icosphere(2), "WEIGHTS_0", 4, weights)).edges(), 0);
}

}  // namespace
}  // namespace meshfront
