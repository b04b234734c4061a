#include "core/front/local_field.h"

#include "gtest/gtest.h"

namespace meshfront {
namespace {

TEST(LocalField, IsTheFieldUntilItIsRefinedAndACone) {
  const GuidanceField field = *GuidanceField::Create({}, {1.25, 0.01, 1}, {});
  LocalField local(field);
  EXPECT_EQ(local.At({3, 0, 0}), 1);
  local.Refine({0, 0, 0}, 0.1, 9);
  EXPECT_DOUBLE_EQ(local.At({0, 0, 0}), 0.1);
  EXPECT_DOUBLE_EQ(local.At({2, 0, 0}), 0.1 + 0.2 * 2);
  EXPECT_EQ(local.At({30, 0, 0}), 1);
  local.Refine({9, 0, 0}, 1e-6, 2);
  EXPECT_DOUBLE_EQ(local.At({9, 0, 0}), 0.01) << "not below the least length";
  EXPECT_EQ(local.RefinementsNear({0, 5, 0}), 1u);
  EXPECT_EQ(local.RefinementsNear({8, 0, 0}), 2u);
}

}  // namespace
}  // namespace meshfront
