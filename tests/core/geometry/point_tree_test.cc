// Against looking at every point.
#include "core/geometry/point_tree.h"

#include <algorithm>
#include <limits>
#include <random>

#include "gtest/gtest.h"

namespace meshfront {
namespace {

// With every tenth point at the place of another.
std::vector<Vec3> RandomPoints(size_t count) {
  std::mt19937 random(7);
  const auto unit = [&] { return static_cast<double>(random()) / 4294967296.0; };
  std::vector<Vec3> points;
  for (size_t i = 0; i < count; ++i)
    points.push_back(i % 10 == 9 ? points[i / 2] : Vec3{unit(), unit(), 0.05 * unit()});
  return points;
}

std::vector<std::pair<double, uint32_t>> AllByDistance(const std::vector<Vec3>& points, const Vec3& x) {
  std::vector<std::pair<double, uint32_t>> all;
  for (uint32_t i = 0; i < points.size(); ++i) all.push_back({SquaredDistance(points[i], x), i});
  std::sort(all.begin(), all.end());
  return all;
}

TEST(PointTree, FindsTheNearestInOrderOfDistanceThenOfIndex) {
  const std::vector<Vec3> points = RandomPoints(700);
  const PointTree tree(points);
  std::vector<std::pair<double, uint32_t>> found;
  for (const size_t count : {size_t{1}, size_t{13}, size_t{2000}}) {
    for (const Vec3& x : {points[3], points[9], Vec3{0.5, 0.5, 3}, Vec3{-1, 0, 0}}) {
      tree.FindNearest(x, count, found);
      auto expected = AllByDistance(points, x);
      expected.resize(std::min(count, points.size()));
      EXPECT_EQ(found, expected);
    }
  }
}

TEST(PointTree, FindsTheNearestOfThoseThatAreAccepted) {
  const std::vector<Vec3> points = RandomPoints(700);
  const PointTree tree(points);
  const auto accept = [](uint32_t i) { return i % 7 == 2; };
  const Vec3 x{0.4, 0.6, 0.2};
  const auto all = AllByDistance(points, x);
  const auto first = std::find_if(all.begin(), all.end(), [&](const auto& entry) { return accept(entry.second); });
  EXPECT_EQ(tree.FindNearest(x, std::numeric_limits<double>::infinity(), accept), first->second);
  EXPECT_EQ(tree.FindNearest(x, 0.99 * first->first, accept), PointTree::kNone);
  EXPECT_EQ(tree.FindNearest(x, 1e9, [](uint32_t) { return false; }), PointTree::kNone);
}

TEST(PointTree, VisitsAllWithinReachOfABox) {
  const std::vector<Vec3> points = RandomPoints(700);
  const PointTree tree(points);
  const Box3 box{{0.2, 0.2, 0}, {0.3, 0.5, 0.1}};
  std::vector<int> visits(points.size(), 0);
  tree.VisitNear(
      box, [](uint32_t) { return 0.1; }, [&](uint32_t i) { ++visits[i]; });
  for (size_t i = 0; i < points.size(); ++i) {
    EXPECT_LE(visits[i], 1);
    if (box.SquaredDistanceTo(points[i]) <= 0.01) {
      EXPECT_EQ(visits[i], 1);
    }
  }
  EXPECT_LT(std::count(visits.begin(), visits.end(), 1), 400);
}

TEST(PointTree, HoldsNothingWhenThereIsNothing) {
  const PointTree tree({});
  std::vector<std::pair<double, uint32_t>> found;
  tree.FindNearest({}, 3, found);
  EXPECT_TRUE(found.empty());
}

}  // namespace
}  // namespace meshfront
