#include "core/mesh/attributes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/mesh/repair.h"
#include "tests/support/matchers.h"
#include "tests/support/shapes.h"
#include "tests/support/textured.h"

namespace meshfront {
namespace {

using ::testing::ElementsAre;
using ::testing::FloatNear;
using testing::IsOk;
using testing::StatusIs;

// A triangle whose corners are the wedges 0, 1, 2.
MeshAttributes OfOneTriangle(std::vector<AttributeChannel> channels, std::vector<float> values) {
  return {std::move(channels), std::move(values), {{0, 1, 2}}, {}};
}

std::vector<float> At(const MeshAttributes& attributes, double u, double v, const Vec3& normal = {0, 0, 1},
                      bool smooth_normals = false) {
  std::vector<float> values;
  AttributeInterpolator(attributes, smooth_normals).Append({0, u, v, normal}, values);
  return values;
}

TEST(AttributeInterpolator, IsLinearForTextureCoordinates) {
  const MeshAttributes a = OfOneTriangle({{"TEXCOORD_1", 2}}, {0, 0, 1, 0, 0, 4});
  EXPECT_THAT(At(a, 0.25, 0.5), ElementsAre(FloatNear(0.25f, 1e-6f), FloatNear(2, 1e-6f)));
}

TEST(AttributeInterpolator, IsLinearForWhatMorphTargetsAdd) {
  const MeshAttributes a = OfOneTriangle({{"MORPH_3_NORMAL", 3}}, {0, 0, 0, 4, 0, 0, 0, 8, 0});
  EXPECT_THAT(At(a, 0.25, 0.5), ElementsAre(1, 4, 0)) << "neither of unit length nor the surface's";
}

TEST(MorphName, SaysWhichTargetAddsToWhat) {
  const auto name = MorphNameOf("MORPH_12_TEXCOORD_1");
  ASSERT_TRUE(name);
  EXPECT_EQ(name->target, 12u);
  EXPECT_EQ(name->attribute, "TEXCOORD_1");
  EXPECT_EQ(NameOfMorph(12, "TEXCOORD_1"), "MORPH_12_TEXCOORD_1");
  for (const char* other : {"MORPH_", "MORPH_1", "MORPH_1_", "MORPH__POSITION", "MORPH_x_POSITION", "MORPH_-1_POSITION",
                            "MORPH_99999999999_POSITION", "morph_1_POSITION"})
    EXPECT_FALSE(MorphNameOf(other)) << other;
  EXPECT_THAT(NamesForMessage({{"NORMAL", 3}, {"MORPH_0_POSITION", 3}, {"MORPH_0_NORMAL", 3}, {"a", 1}}),
              ElementsAre("NORMAL", "morph targets", "a"));
  EXPECT_THAT(ValidateChannels({{"MORPH_0_TANGENT", 2}}),
              StatusIs(absl::StatusCode::kInvalidArgument, "must have 3 to"));
}

TEST(AttributeInterpolator, KeepsNormalsOfUnitLengthAndTakesTheSurfacesWhereFacesAreFlat) {
  const MeshAttributes a = OfOneTriangle({{"NORMAL", 3}}, {1, 0, 0, 0, 1, 0, 0, 0, 1});
  const float third = 1 / std::sqrt(3.0f);
  EXPECT_THAT(At(a, 1.0 / 3, 1.0 / 3),
              ElementsAre(FloatNear(third, 1e-6f), FloatNear(third, 1e-6f), FloatNear(third, 1e-6f)));
  EXPECT_THAT(At(a, 1.0 / 3, 1.0 / 3, {0, 1, 0}, true), ElementsAre(0, 1, 0));
}

TEST(AttributeInterpolator, KeepsTangentsOrthogonalAndTheirSign) {
  const MeshAttributes a = OfOneTriangle({{"TANGENT", 4}}, {1, 0, 0, -1, 1, 0, 1, -1, 1, 0, -0.5, 1});
  EXPECT_THAT(At(a, 0.3, 0.3), ElementsAre(FloatNear(1, 1e-6f), 0, 0, -1));
}

// Three joints a corner, of which four are kept in all.
TEST(AttributeInterpolator, KeepsTheJointsThatWeighMost) {
  const MeshAttributes a = OfOneTriangle({{"JOINTS_0", 4}, {"WEIGHTS_0", 4}}, {5, 2, 0, 0, 0.75, 0.25, 0, 0,  //
                                                                               5, 3, 0, 0, 0.5,  0.5,  0, 0,  //
                                                                               7, 8, 0, 0, 0.9,  0.1,  0, 0});
  const std::vector<float> values = At(a, 0.25, 0.25);
  EXPECT_THAT(std::vector<float>(values.begin(), values.begin() + 4), ElementsAre(5, 7, 2, 3));
  EXPECT_NEAR(values[4] + values[5] + values[6] + values[7], 1, 1e-6);
  EXPECT_NEAR(values[4], 0.5 / (0.5 + 0.225 + 0.125 + 0.125), 1e-6);
}

TEST(ValidateAttributes, NamesWhatDoesNotFit) {
  MeshAttributes a = OfOneTriangle({{"NORMAL", 3}}, {1, 0, 0, 0, 1, 0, 0, 0, 1});
  EXPECT_THAT(ValidateAttributes(a, 1), IsOk());
  constexpr auto kInvalid = absl::StatusCode::kInvalidArgument;
  EXPECT_THAT(ValidateAttributes(a, 2), StatusIs(kInvalid, "attributes.corners has 1 elements"));
  a.corners[0][1] = 3;
  EXPECT_THAT(ValidateAttributes(a, 1), StatusIs(kInvalid, "triangle 0 names wedge 3; there are 3"));
  a.corners[0][1] = 1, a.values[4] = NAN;
  EXPECT_THAT(ValidateAttributes(a, 1), StatusIs(kInvalid, "wedge 1 is not finite"));
  EXPECT_THAT(ValidateChannels({{"A", 1}, {"A", 2}}), StatusIs(kInvalid, "attribute A is there twice"));
  EXPECT_THAT(ValidateChannels({{"TANGENT", 3}}), StatusIs(kInvalid, "it must have 4 to 16"));
}

// Every corner has the values that its place has, whatever became of its face.
void ExpectPlacesInValues(const TriangleMesh& mesh) {
  for (size_t f = 0; f < mesh.triangles.size(); ++f) {
    for (int i = 0; i < 3; ++i) {
      const Vec3& p = mesh.PositionAt(mesh.triangles[f][i]);
      const absl::Span<const float> values = mesh.attributes.WedgeAt(mesh.attributes.corners[f][i]);
      EXPECT_LT(Distance(p, {values[0], values[1], values[2]}), 1e-6) << f;
    }
  }
}

TEST(RepairMesh, TakesAttributesAlong) {
  const auto place = [](const Vec3& p, const Vec3&) {
    return std::vector<float>{static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)};
  };
  TriangleMesh mesh = testing::Icosphere(2);
  std::swap(mesh.triangles[7][0], mesh.triangles[7][1]);  // turned over
  mesh.triangles.push_back(mesh.triangles[3]);            // twice
  // A vertex on the long side of a face of no area.
  const Triangle t = mesh.triangles[11];
  mesh.positions.push_back(0.5 * (mesh.PositionAt(t[0]) + mesh.PositionAt(t[1])));
  const VertexId middle(mesh.positions.size() - 1);
  mesh.triangles[11] = {t[0], middle, t[2]};
  mesh.triangles.push_back({middle, t[1], t[2]});
  mesh.triangles.push_back({t[0], t[1], middle});
  mesh = testing::WithChannel(mesh, "PLACE", 3, place);
  Context context;
  const absl::StatusOr<RepairResult> repaired = RepairMesh(mesh, context);
  ASSERT_THAT(repaired, IsOk());
  EXPECT_THAT(repaired->actions, ::testing::Not(::testing::IsEmpty()));
  ASSERT_EQ(repaired->mesh.attributes.corners.size(), repaired->mesh.triangles.size());
  ExpectPlacesInValues(repaired->mesh);
}

}  // namespace
}  // namespace meshfront
