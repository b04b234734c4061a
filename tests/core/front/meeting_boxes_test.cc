#include "core/front/meeting_boxes.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <set>

#include "gtest/gtest.h"

namespace meshfront {
namespace {

using Pairs = std::set<std::pair<uint32_t, uint32_t>>;

// Small triangles all over a cube, each with a vertex of the one before.
struct Scatter {
  Scatter(int count, double size) {
    std::mt19937 random(7);
    const auto uniform = [&] { return std::uniform_real_distribution<double>(-1, 1)(random); };
    for (int i = 0; i < count; ++i) {
      const Vec3 center = {uniform(), uniform(), uniform()};
      const auto first = static_cast<uint32_t>(positions.size());
      for (int k = 0; k < 3; ++k) positions.push_back(center + size * Vec3{uniform(), uniform(), uniform()});
      triangles.push_back({VertexId(i % 3 == 1 ? first - 1 : first), VertexId(first + 1), VertexId(first + 2)});
      is_wanted.push_back(i % 4 != 0);
    }
    for (size_t v = 0; v < positions.size(); ++v) keeps_apart.push_back(v % 2 == 0);
  }
  bool BoxesMeet(uint32_t i, uint32_t j) const {
    for (int axis = 0; axis < 3; ++axis) {
      double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
      for (int k = 0; k < 3; ++k) {
        for (const auto& [t, of] : {std::pair{i, 0}, {j, 1}}) {
          const double x = positions[triangles[t][k].index()][axis];
          low[of] = std::min(low[of], x), high[of] = std::max(high[of], x);
        }
      }
      if (low[0] > high[1] || low[1] > high[0]) return false;
    }
    return true;
  }
  bool AreKeptApart(uint32_t i, uint32_t j) const {
    for (const VertexId v : triangles[i]) {
      if (keeps_apart[v.index()] && std::count(triangles[j].begin(), triangles[j].end(), v) > 0) return true;
    }
    return false;
  }
  Pairs Expected() const {
    Pairs pairs;
    for (uint32_t i = 0; i < triangles.size(); ++i) {
      for (uint32_t j = i + 1; j < triangles.size(); ++j) {
        if ((is_wanted[i] || is_wanted[j]) && BoxesMeet(i, j) && !AreKeptApart(i, j)) pairs.insert({i, j});
      }
    }
    return pairs;
  }
  Pairs Found() const {
    const MeetingBoxes found = FindMeetingBoxes(positions, triangles, is_wanted, keeps_apart);
    Pairs pairs;
    for (const auto& [i, j] : found.pairs) EXPECT_TRUE(pairs.insert(std::minmax(i, j)).second) << "found twice";
    return pairs;
  }

  std::vector<Vec3> positions;
  std::vector<Triangle> triangles;
  std::vector<uint8_t> is_wanted, keeps_apart;
};

TEST(MeetingBoxes, FindsThePairsThatComparingAllWithAllFinds) {
  for (const int count : {1, 2, 3, 4, 5, 17, 64, 65, 700}) {
    const Scatter scatter(count, count < 20 ? 0.8 : 0.1);
    const Pairs expected = scatter.Expected();
    EXPECT_EQ(scatter.Found(), expected) << count;
    if (count > 4) {
      EXPECT_GT(expected.size(), 2u) << count;
    }
  }
}

TEST(MeetingBoxes, AreThoseOfAnyScaleAndPlace) {
  Scatter scatter(300, 0.1);
  const Pairs expected = scatter.Expected();
  for (const double scale : {0x1p-60, 0x1p60}) {
    Scatter moved = scatter;
    for (Vec3& p : moved.positions) p = scale * (p + Vec3{64, -32, 8});
    EXPECT_EQ(moved.Found(), moved.Expected()) << scale;
    EXPECT_GE(moved.Expected().size(), expected.size() - 2) << "but for the rounding of the move";
  }
}

TEST(MeetingBoxes, TouchingOnesMeet) {
  Scatter scatter(0, 0);
  scatter.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {1, 2, 0}, {2, 1, 0}};
  scatter.triangles = {{VertexId(0), VertexId(1), VertexId(2)}, {VertexId(3), VertexId(4), VertexId(5)}};
  scatter.is_wanted = {0, 1}, scatter.keeps_apart.assign(6, 0);
  EXPECT_EQ(scatter.Found(), (Pairs{{0, 1}}));
  scatter.is_wanted = {0, 0};
  EXPECT_EQ(scatter.Found(), Pairs{});
}

TEST(MeetingBoxes, OrderNamesEachTriangleOnce) {
  const Scatter scatter(300, 0.1);
  std::vector<uint32_t> order =
      FindMeetingBoxes(scatter.positions, scatter.triangles, scatter.is_wanted, scatter.keeps_apart).order;
  std::sort(order.begin(), order.end());
  ASSERT_EQ(order.size(), 300u);
  for (uint32_t i = 0; i < order.size(); ++i) EXPECT_EQ(order[i], i);
}

}  // namespace
}  // namespace meshfront
