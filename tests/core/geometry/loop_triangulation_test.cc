#include "core/geometry/loop_triangulation.h"

#include <limits>
#include <random>
#include <set>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace meshfront {
namespace {

using ::testing::SizeIs;

constexpr double kForbidden = std::numeric_limits<double>::infinity();

// The least weight of all triangulations of the positions first … last, by trying every apex everywhere.
double BruteForce(int first, int last, const ClosureWeight& weight) {
  if (last - first < 2) return 0;
  double best = kForbidden;
  for (int apex = first + 1; apex < last; ++apex) {
    const double own = weight(first, apex, last);
    if (own < 0) continue;
    best = std::min(best, own + BruteForce(first, apex, weight) + BruteForce(apex, last, weight));
  }
  return best;
}

// A weight for each triangle of n positions; some are forbidden.
struct RandomWeights {
  RandomWeights(int n, int percent_forbidden, uint64_t seed) : n(n), table(n * n * n) {
    std::mt19937_64 random(seed);
    for (double& w : table)
      w = static_cast<int>(random() % 100) < percent_forbidden ? -1 : static_cast<double>(random() % 1000) / 999;
  }
  double operator()(int first, int apex, int last) const { return table[(first * n + apex) * n + last]; }
  int n;
  std::vector<double> table;
};

TEST(Closure, HasTheLeastWeightOfAllTriangulations) {
  for (int n = 3; n <= 8; ++n) {
    for (uint64_t seed = 1; seed <= 40; ++seed) {
      const RandomWeights weight(n, 0, seed);
      const auto steps = TriangulateLoop(n, weight);
      ASSERT_TRUE(steps.has_value());
      double sum = 0;
      for (const ClosureStep& s : *steps) sum += weight(s.first, s.apex, s.last);
      EXPECT_NEAR(sum, BruteForce(0, n - 1, weight), 1e-12) << n << " vertices, seed " << seed;
    }
  }
}

TEST(Closure, AvoidsForbiddenTrianglesOrFindsThatItCannot) {
  int possible = 0, impossible = 0;
  for (uint64_t seed = 1; seed <= 300; ++seed) {
    const RandomWeights weight(7, 60, seed);
    const double best = BruteForce(0, 6, weight);
    const auto steps = TriangulateLoop(7, weight);
    ASSERT_EQ(steps.has_value(), best < kForbidden) << seed;
    if (!steps) {
      ++impossible;
      continue;
    }
    ++possible;
    for (const ClosureStep& s : *steps) EXPECT_GE(weight(s.first, s.apex, s.last), 0);
  }
  EXPECT_GT(possible, 20);
  EXPECT_GT(impossible, 20);
}

TEST(Closure, StandsEachTriangleOnASideOfAnEarlierOne) {
  for (int n = 3; n <= 20; ++n) {
    const auto steps = TriangulateLoop(n, RandomWeights(n, 0, n));
    ASSERT_TRUE(steps.has_value());
    EXPECT_THAT(*steps, SizeIs(n - 2));
    std::set<std::pair<int, int>> bases = {{0, n - 1}};
    for (const ClosureStep& s : *steps) {
      EXPECT_EQ(bases.erase({s.first, s.last}), 1u) << "no such base, or used twice";
      EXPECT_LT(s.first, s.apex);
      EXPECT_LT(s.apex, s.last);
      bases.insert({s.first, s.apex});
      bases.insert({s.apex, s.last});
    }
    for (const auto& [first, last] : bases)
      EXPECT_EQ(last, first + 1) << "a side that is no edge of the loop is left open";
  }
}

TEST(Closure, NeedsThreeVertices) {
  for (const int n : {0, 1, 2}) EXPECT_FALSE(TriangulateLoop(n, [](int, int, int) { return 0.0; }).has_value());
  EXPECT_FALSE(TriangulateLoop(3, [](int, int, int) { return -1.0; }).has_value());
  EXPECT_TRUE(TriangulateLoop(3, [](int, int, int) { return 0.0; }).has_value());
}

TEST(Closure, TakesAWeightThatIsNoNumberForForbidden) {
  const auto weight = [](int first, int, int last) {
    return last - first == 3 ? std::numeric_limits<double>::quiet_NaN() : 1.0;
  };
  EXPECT_FALSE(TriangulateLoop(4, weight).has_value());
}

}  // namespace
}  // namespace meshfront
