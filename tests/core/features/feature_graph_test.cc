#include "core/features/feature_graph.h"

#include <map>
#include <set>
#include <utility>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/core/features/crease_surfaces.h"

namespace meshfront {
namespace {

using testing::CreasedSurfaceOf;
using ::testing::IsEmpty;
using ::testing::SizeIs;

// What a graph must be: every half-edge without a neighbour in one curve, at its place and in its direction; curves whole, from
// node to node, without nodes inside.
void ExpectSound(const MeshSurface& surface, const FeatureGraph& graph) {
  size_t covered = 0;
  for (uint32_t h = 0; h < 3 * surface.mesh().triangles.size(); ++h) {
    if (surface.adjacency().OppositeOf(h) != kNoHalfEdge) continue;
    ++covered;
    const CurveSegment at = graph.SegmentOf(h);
    ASSERT_LT(at.curve, graph.curves().size());
    const FeatureCurve& curve = graph.curves()[at.curve];
    ASSERT_LT(at.segment, curve.forward.size());
    EXPECT_EQ((at.forward ? curve.forward : curve.backward)[at.segment], h);
    const uint32_t from = curve.vertices[at.segment];
    const uint32_t to = curve.vertices[(at.segment + 1) % curve.vertices.size()];
    EXPECT_EQ(surface.OriginalOf(OriginOf(surface.mesh(), h)), at.forward ? from : to);
    EXPECT_EQ(surface.OriginalOf(TargetOf(surface.mesh(), h)), at.forward ? to : from);
  }
  size_t halves = 0;
  for (const FeatureCurve& curve : graph.curves()) {
    ASSERT_EQ(curve.backward.size(), curve.forward.size());
    ASSERT_EQ(curve.vertices.size(), curve.forward.size() + (curve.closed ? 0 : 1));
    for (size_t i = 0; i < curve.forward.size(); ++i) {
      const bool both = curve.forward[i] != kNoHalfEdge && curve.backward[i] != kNoHalfEdge;
      EXPECT_EQ(both, curve.is_crease);
      halves += both ? 2 : 1;
    }
    for (size_t i = 0; i < curve.vertices.size(); ++i) {
      const bool is_end = !curve.closed && (i == 0 || i + 1 == curve.vertices.size());
      EXPECT_EQ(graph.IsNode(curve.vertices[i]), is_end);
    }
  }
  EXPECT_EQ(halves, covered) << "no half-edge in two curves";
}

size_t CountNodes(const FeatureGraph& graph) {
  std::set<uint32_t> nodes;
  for (const FeatureCurve& curve : graph.curves()) {
    for (const uint32_t v : curve.vertices) {
      if (graph.IsNode(v)) nodes.insert(v);
    }
  }
  return nodes.size();
}

TEST(FeatureGraph, IsEmptyOnASmoothClosedSurface) {
  const auto surface = CreasedSurfaceOf(testing::Icosphere(2));
  EXPECT_THAT(FeatureGraph(*surface).curves(), IsEmpty());
}

TEST(FeatureGraph, HasTwelveCurvesBetweenEightNodesOnACube) {
  for (const int n : {1, 5}) {
    const auto surface = CreasedSurfaceOf(testing::Cube(n));
    const FeatureGraph graph(*surface);
    ExpectSound(*surface, graph);
    EXPECT_THAT(graph.curves(), SizeIs(12));
    EXPECT_EQ(CountNodes(graph), 8u);
    for (const FeatureCurve& curve : graph.curves()) {
      EXPECT_TRUE(curve.is_crease);
      EXPECT_THAT(curve.forward, SizeIs(n));
      EXPECT_NEAR(graph.CurveOf(curve).length(), 2, 1e-12);
    }
  }
}

TEST(FeatureGraph, HasTwoClosedCurvesWithoutNodesOnACappedCylinder) {
  const auto surface = CreasedSurfaceOf(testing::CappedCylinder(1, 2, 24, 6));
  const FeatureGraph graph(*surface);
  ExpectSound(*surface, graph);
  ASSERT_THAT(graph.curves(), SizeIs(2));
  for (const FeatureCurve& curve : graph.curves()) {
    EXPECT_TRUE(curve.closed && curve.is_crease);
    EXPECT_THAT(curve.forward, SizeIs(24));
    EXPECT_TRUE(graph.CurveOf(curve).closed());
  }
}

TEST(FeatureGraph, HasTheRimOfASheetAsAClosedCurve) {
  const auto surface = CreasedSurfaceOf(testing::Sheet(4));
  const FeatureGraph graph(*surface);
  ExpectSound(*surface, graph);
  ASSERT_THAT(graph.curves(), SizeIs(1));
  EXPECT_TRUE(graph.curves()[0].closed);
  EXPECT_FALSE(graph.curves()[0].is_crease);
}

TEST(FeatureGraph, DividesARimWhereACreaseEndsOnIt) {
  const auto surface = CreasedSurfaceOf(testing::Roof(10));
  const FeatureGraph graph(*surface);
  ExpectSound(*surface, graph);
  EXPECT_THAT(graph.curves(), SizeIs(3));
  EXPECT_EQ(CountNodes(graph), 2u);
  std::multiset<std::pair<bool, size_t>> found;
  for (const FeatureCurve& curve : graph.curves()) found.insert({curve.is_crease, curve.forward.size()});
  EXPECT_EQ(found, (std::multiset<std::pair<bool, size_t>>{{true, 10}, {false, 20}, {false, 20}}));
}

TEST(FeatureGraph, KnowsCreasesFromRimsOnAnOpenBox) {
  const auto surface = CreasedSurfaceOf(testing::OpenBox(3));
  const FeatureGraph graph(*surface);
  ExpectSound(*surface, graph);
  EXPECT_THAT(graph.curves(), SizeIs(12));
  int creases = 0;
  for (const FeatureCurve& curve : graph.curves()) creases += curve.is_crease;
  EXPECT_EQ(creases, 8);
}

TEST(FeatureGraph, HasTwoCurvesBetweenTheSameNodesOnAHalfDisk) {
  const auto surface = CreasedSurfaceOf(testing::HalfDiskPrism());
  const FeatureGraph graph(*surface);
  ExpectSound(*surface, graph);
  EXPECT_EQ(CountNodes(graph), 4u);
  std::map<std::pair<uint32_t, uint32_t>, int> between;
  for (const FeatureCurve& curve : graph.curves()) ++between[std::minmax(curve.start(), curve.end())];
  EXPECT_THAT(graph.curves(), SizeIs(6));
  EXPECT_THAT(between, SizeIs(4));
}

TEST(FeatureGraph, HasACurveFromANodeToItselfOnADrop) {
  const auto surface = CreasedSurfaceOf(testing::DropPrism());
  const FeatureGraph graph(*surface);
  ExpectSound(*surface, graph);
  ASSERT_THAT(graph.curves(), SizeIs(3));
  int loops = 0;
  for (const FeatureCurve& curve : graph.curves()) loops += curve.start() == curve.end();
  EXPECT_EQ(loops, 2);
  for (const FeatureCurve& curve : graph.curves()) EXPECT_FALSE(curve.closed) << "it has an end";
}

}  // namespace
}  // namespace meshfront
