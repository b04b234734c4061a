#include "core/front/insertion_budget.h"

#include <gtest/gtest.h>

#include <limits>

namespace meshfront {
namespace {

constexpr double kWorst = 2.5, kFar = 1.5, kNear = 1.1;

TEST(InsertionBudget, KeepsSomeForWhatComesLast) {
  const InsertionBudget budget(100, 1000);
  EXPECT_EQ(budget.Left(0, 0, kFar), 25u) << "clusters may come first";
  EXPECT_LT(budget.Left(0, 500, kFar), 75u);
  EXPECT_GE(budget.Left(0, 500, kFar), 50u);
  EXPECT_EQ(budget.Left(0, 1000, kFar), 100u);
  EXPECT_EQ(budget.Left(0, 1500, kFar), 100u) << "more triangles than predicted";
}

TEST(InsertionBudget, KeepsSomeForWhatIsFartherOff) {
  const InsertionBudget budget(100, 1000);
  EXPECT_EQ(budget.Left(0, 1000, kNear), 60u);
  EXPECT_EQ(budget.Left(60, 1000, kNear), 0u);
  EXPECT_EQ(budget.Left(60, 1000, kFar), 40u);
  EXPECT_EQ(budget.Left(120, 1000, kFar), 0u);
  EXPECT_EQ(budget.Left(120, 1000, kWorst), 30u) << "one that is left out makes the maximum";
  EXPECT_EQ(budget.Left(150, 1000, kWorst), 0u);
}

TEST(InsertionBudget, HasNoEndWhereNoCountIsWanted) {
  const InsertionBudget budget(std::numeric_limits<double>::infinity(), 1000);
  EXPECT_FALSE(budget.IsLimited());
  EXPECT_GE(budget.Left(1000000, 0, kNear), 1000000u);
  EXPECT_TRUE(InsertionBudget(100, 0).IsLimited());
  EXPECT_EQ(InsertionBudget(100, 0).Left(0, 0, kFar), 100u) << "no prediction";
}

}  // namespace
}  // namespace meshfront
