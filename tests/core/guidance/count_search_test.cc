#include "core/guidance/count_search.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

namespace meshfront {
namespace {

constexpr double kExponent = -2;
constexpr double kNoEnd = std::numeric_limits<double>::infinity();

// How often the count is asked for until it is within a thousandth of the target; 0 if it is not in 60 times.
int StepsTo(double target, double first, double last, const std::function<double(double)>& count) {
  CountSearch search(target, kExponent, kExponent, last);
  double place = first;
  for (int step = 1; step <= 60; ++step) {
    const double found = count(place);
    if (std::abs(found - target) < 1e-3) return step;
    place = search.Next(place, found);
    EXPECT_LE(place, last);
    if (search.IsExhausted() || search.IsAtAJump()) return 0;
  }
  return 0;
}

TEST(CountSearch, NeedsTwoStepsOnALine) {
  EXPECT_EQ(StepsTo(10, 1, kNoEnd, [](double x) { return 11 - 2 * x; }), 2) << "of the slope that was given";
  EXPECT_LE(StepsTo(10, 1, kNoEnd, [](double x) { return 11 - 0.7 * x; }), 6) << "of another";
}

TEST(CountSearch, FindsWhereTheCountBends) {
  EXPECT_GT(StepsTo(2, -5, kNoEnd, [](double x) { return x < 0 ? -0.1 * x + 3 : 3 - 3 * x; }), 0);
  EXPECT_GT(StepsTo(0.5, 6, kNoEnd, [](double x) { return std::exp(-0.2 * x); }), 0);
}

TEST(CountSearch, SeesThatThereIsAJump) {
  CountSearch search(5, kExponent, kExponent, kNoEnd);
  double place = 0;
  for (int step = 0; step < 60 && !search.IsAtAJump(); ++step) {
    EXPECT_FALSE(search.IsExhausted());
    place = search.Next(place, place < 1.25 ? 6 - 0.1 * place : 4 - 0.1 * place);
  }
  EXPECT_TRUE(search.IsAtAJump());
  EXPECT_NEAR(place, 1.25, 1e-2);
}

TEST(CountSearch, SeesThatTheEndHasTooMany) {
  CountSearch search(1, kExponent, kExponent, 4);
  double place = 0;
  for (int step = 0; step < 20 && !search.IsExhausted(); ++step) place = search.Next(place, 9 - place);
  EXPECT_TRUE(search.IsExhausted());
  EXPECT_EQ(place, 4);
}

TEST(CountSearch, SeesThatThePlaceHasNoInfluenceAnyMore) {
  CountSearch search(10, kExponent, kExponent, kNoEnd);
  double place = 0;
  int steps = 0;
  for (; steps < 40 && !search.IsExhausted(); ++steps) place = search.Next(place, 8);
  EXPECT_TRUE(search.IsExhausted());
  EXPECT_LT(steps, 10);
}

}  // namespace
}  // namespace meshfront
