#include "core/guidance/blend.h"

#include <vector>

#include "gtest/gtest.h"
#include "tests/support/matchers.h"

namespace meshfront {
namespace {

std::vector<BlendValues> Solve(uint32_t count, const std::vector<WeightedEdge>& edges,
                               const std::vector<std::pair<uint32_t, BlendValues>>& fixed) {
  const auto values = SolveBlend(count, edges, fixed, {});
  EXPECT_THAT(values, testing::IsOk());
  return values.ok() ? *values : std::vector<BlendValues>(count);
}

// A chain of five nodes, fixed at its ends.
TEST(Blend, IsLinearAlongAChainOfEqualWeights) {
  const auto values = Solve(5, {{0, 1, 2}, {1, 2, 2}, {2, 3, 2}, {3, 4, 2}}, {{0, {1, 8}}, {4, {0, 4}}});
  for (int i = 0; i < 5; ++i) {
    EXPECT_NEAR(values[i][0], 1 - i / 4.0, 1e-12);
    EXPECT_NEAR(values[i][1], 8 - i, 1e-12);
  }
}

TEST(Blend, LeansTowardsTheHeavierEdge) {
  const auto values = Solve(3, {{0, 1, 3}, {1, 2, 1}}, {{0, {1, 1}}, {2, {0, 0}}});
  EXPECT_NEAR(values[1][0], 0.75, 1e-12);
}

TEST(Blend, IsNothingWhereNoFixedNodeIsJoined) {
  const auto values = Solve(4, {{0, 1, 1}, {2, 3, 1}}, {{0, {1, 2}}});
  EXPECT_EQ(values[1], (BlendValues{1, 2}));
  EXPECT_EQ(values[2], (BlendValues{0, 0}));
  EXPECT_EQ(values[3], (BlendValues{0, 0}));
}

}  // namespace
}  // namespace meshfront
