#include "core/geometry/bvh.h"

#include <gtest/gtest.h>

#include <random>
#include <set>

namespace meshfront {
namespace {

struct Soup {
  std::vector<Vec3> positions;
  std::vector<TriangleBvh::Corners> triangles;
  double DistanceTo(const Vec3& p, uint32_t f) const {
    const auto& t = triangles[f];
    return Distance(
        p,
        ClosestPointOnTriangle(p, positions[t[0].index()], positions[t[1].index()], positions[t[2].index()]).position);
  }
};

Vec3 RandomPoint(std::mt19937& random) {
  std::uniform_real_distribution<double> uniform(-1, 1);
  const double x = uniform(random), y = uniform(random), z = uniform(random);
  return {x, y, z};
}

// `count` triangles of about the size `extent` in a cube around `center`.
Soup RandomSoup(int count, double extent, const Vec3& center, uint32_t seed) {
  std::mt19937 random(seed);
  Soup soup;
  for (int i = 0; i < count; ++i) {
    const Vec3 middle = center + RandomPoint(random);
    for (int k = 0; k < 3; ++k) soup.positions.push_back(middle + extent * RandomPoint(random));
    soup.triangles.push_back({VertexId(3 * i), VertexId(3 * i + 1), VertexId(3 * i + 2)});
  }
  return soup;
}

TEST(TriangleBvh, EmptyTreeFindsNothing) {
  const TriangleBvh bvh({}, {});
  EXPECT_FALSE(bvh.FindClosestPoint({0, 0, 0}).has_value());
  EXPECT_FALSE(bvh.FindFirstHit({0, 0, 0}, {1, 0, 0}, 0, 1).has_value());
  bvh.VisitOverlaps(Box3{{-1, -1, -1}, {1, 1, 1}}, [](FaceId) { return ADD_FAILURE(), true; });
}

TEST(TriangleBvh, ClosestPointEqualsTheBruteForceMinimum) {
  for (const Vec3& center : {Vec3{}, Vec3{1e6, -2e6, 3e6}}) {
    for (const int count : {1, 3, 5, 400}) {
      const Soup soup = RandomSoup(count, 0.2, center, count);
      const TriangleBvh bvh(soup.positions, soup.triangles);
      std::mt19937 random(7);
      for (int i = 0; i < 300; ++i) {
        const Vec3 p = center + (i % 3 == 0 ? 20.0 : 1.2) * RandomPoint(random);
        double best = std::numeric_limits<double>::infinity();
        for (uint32_t f = 0; f < soup.triangles.size(); ++f) best = std::min(best, soup.DistanceTo(p, f));
        const auto hit = bvh.FindClosestPoint(p);
        ASSERT_TRUE(hit.has_value());
        ASSERT_EQ(std::sqrt(hit->squared_distance), best);
        ASSERT_EQ(soup.DistanceTo(p, hit->face.index()), best);
      }
    }
  }
}

TEST(TriangleBvh, ClosestPointKeepsToItsBoundAndToTheFilter) {
  const Soup soup = RandomSoup(50, 0.1, {}, 3);
  const TriangleBvh bvh(soup.positions, soup.triangles);
  const Vec3 p{3, 0, 0};
  const auto first = bvh.FindClosestPoint(p);
  const double distance = std::sqrt(first->squared_distance);
  EXPECT_FALSE(bvh.FindClosestPoint(p, 0.999 * distance).has_value());
  EXPECT_TRUE(bvh.FindClosestPoint(p, 1.001 * distance).has_value());
  const auto second = bvh.FindClosestPoint(p, 10, [&](FaceId f) { return f != first->face; });
  EXPECT_NE(second->face, first->face);
  EXPECT_GE(second->squared_distance, first->squared_distance);
}

TEST(TriangleBvh, TiesGoToTheSmallerFace) {
  // 100 copies of one triangle.
  Soup soup;
  soup.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  soup.triangles.assign(100, {VertexId(0), VertexId(1), VertexId(2)});
  const TriangleBvh bvh(soup.positions, soup.triangles);
  EXPECT_EQ(bvh.FindClosestPoint({0.2, 0.2, 1})->face, FaceId(0));
  EXPECT_EQ(bvh.FindFirstHit({0.2, 0.2, 1}, {0, 0, -1}, 0, 2)->face, FaceId(0));
}

TEST(TriangleBvh, FirstHitEqualsTheBruteForceOne) {
  const Soup soup = RandomSoup(300, 0.6, {10, 0, 0}, 5);
  const TriangleBvh bvh(soup.positions, soup.triangles);
  std::vector<TriangleBvh> singles;
  for (size_t f = 0; f < soup.triangles.size(); ++f) {
    singles.emplace_back(soup.positions, absl::MakeConstSpan(soup.triangles).subspan(f, 1));
  }
  std::mt19937 random(8);
  int hits = 0;
  for (int i = 0; i < 500; ++i) {
    const Vec3 origin = Vec3{10, 0, 0} + 2 * RandomPoint(random);
    Vec3 direction = RandomPoint(random);
    if (i % 5 == 0) direction.x = 0;
    if (i % 5 == 1) direction.y = direction.z = 0;
    std::optional<SegmentHit> best;
    for (uint32_t f = 0; f < soup.triangles.size(); ++f) {
      const auto hit = singles[f].FindFirstHit(origin, direction, 0.1, 2);
      if (hit && (!best || hit->t < best->t)) best = SegmentHit{FaceId(f), hit->t, {}};
    }
    const auto got = bvh.FindFirstHit(origin, direction, 0.1, 2);
    ASSERT_EQ(got.has_value(), best.has_value());
    if (!got) continue;
    ++hits;
    EXPECT_EQ(got->face, best->face);
    EXPECT_EQ(got->t, best->t);
    EXPECT_LT(soup.DistanceTo(origin + got->t * direction, got->face.index()), 1e-12);
  }
  EXPECT_GT(hits, 100);
}

TEST(TriangleBvh, RaysThroughSharedEdgesAndVerticesDoNotSlipThrough) {
  // A fan of 7 triangles around an odd centre; rays aim at points of its spokes and at the centre itself.
  Soup soup;
  soup.positions.push_back({0.1, 0.07, 0.3});
  for (int i = 0; i < 7; ++i) soup.positions.push_back({std::cos(0.9 * i), std::sin(0.9 * i), 0.01 * i});
  for (int i = 0; i < 7; ++i) soup.triangles.push_back({VertexId(0), VertexId(1 + i), VertexId(1 + (i + 1) % 7)});
  const TriangleBvh bvh(soup.positions, soup.triangles);
  std::mt19937 random(9);
  for (int i = 0; i < 2000; ++i) {
    const Vec3 target = Lerp(soup.positions[0], soup.positions[1 + i % 7], 0.9 * (i % 100) / 100.0);
    const Vec3 origin = Vec3{0, 0, 5} + RandomPoint(random);
    const auto hit = bvh.FindFirstHit(origin, target - origin, 0, 2);
    ASSERT_TRUE(hit.has_value()) << i;
    ASSERT_NEAR(hit->t, 1, 1e-9);
  }
}

TEST(TriangleBvh, VisitsEveryTriangleWhoseBoxMeetsTheBox) {
  const Soup soup = RandomSoup(300, 0.1, {}, 6);
  const TriangleBvh bvh(soup.positions, soup.triangles);
  std::mt19937 random(10);
  for (int i = 0; i < 100; ++i) {
    Box3 box;
    box.Extend(RandomPoint(random));
    box.Extend(box.min + 0.3 * RandomPoint(random));
    std::set<uint32_t> expected, got;
    for (uint32_t f = 0; f < soup.triangles.size(); ++f) {
      const Box3 own = bvh.BoxOf(FaceId(f));
      bool meets = true;
      for (int k = 0; k < 3; ++k) meets &= own.min[k] <= box.max[k] && own.max[k] >= box.min[k];
      if (meets) expected.insert(f);
    }
    bvh.VisitOverlaps(box, [&](FaceId f) { return got.insert(f.index()).second; });
    EXPECT_EQ(got, expected);
  }
  int visited = 0;
  bvh.VisitOverlaps(bvh.bounds(), [&](FaceId) { return ++visited < 5; });
  EXPECT_EQ(visited, 5);
}

// All pairs against all.
TEST(TriangleBvh, VisitsEveryPairWhoseBoxesMeetOnce) {
  const Soup soup = RandomSoup(300, 0.3, {}, 6);
  const TriangleBvh bvh(soup.positions, soup.triangles);
  std::set<std::pair<uint32_t, uint32_t>> expected, got;
  for (uint32_t f = 0; f < soup.triangles.size(); ++f) {
    bvh.VisitOverlaps(bvh.BoxOf(FaceId(f)), [&](FaceId g) {
      if (f < g.index()) expected.insert({f, g.index()});
      return true;
    });
  }
  bvh.VisitOverlappingPairs([&](FaceId f, FaceId g) {
    EXPECT_TRUE(got.insert(std::minmax(f.index(), g.index())).second) << "a pair came twice";
  });
  EXPECT_EQ(got, expected);
  EXPECT_GT(got.size(), 100u);
}

TEST(TriangleBvh, FlatAndTinyInputsWork) {
  Soup soup;
  soup.positions = {{0, 0, 0}, {1e-300, 0, 0}, {0, 1e-300, 0}, {0, 0, 0}};
  soup.triangles.assign(9, {VertexId(0), VertexId(1), VertexId(2)});
  soup.triangles.push_back({VertexId(0), VertexId(0), VertexId(3)});
  const TriangleBvh bvh(soup.positions, soup.triangles);
  EXPECT_EQ(bvh.FindClosestPoint({0, 0, 2})->squared_distance, 4);
}

}  // namespace
}  // namespace meshfront
