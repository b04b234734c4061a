#include "core/front/loop_closing.h"

#include <algorithm>
#include <vector>

#include "core/front/fence_index.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/core/front/fake_surfaces.h"

namespace meshfront {
namespace {

// Two closures have the same area, one of them with a triangle that has next to none.
TEST(ProposeClosure, TakesATriangleWithoutAreaOnlyWhereThereIsNoOther) {
  for (const int begin : {0, 1, 2, 3}) {                                            // whichever comes first
    std::vector<Vec3> places = {{0, 0, 0}, {1, 0.5, 0}, {2, 0, 0}, {1, -1e-9, 0}};  // clockwise: open inside
    std::rotate(places.begin(), places.begin() + begin, places.end());
    const testing::PlaneSurface surface;
    FrontSet fronts;
    const FenceIndex fences(fronts);
    const Proposer proposer(surface, fronts, fences);
    std::vector<WindowVertexId> v;
    for (const Vec3& p : places) v.push_back(fronts.AddVertex({p, {0, 0, 1}, 0}, 1, 0));
    const std::vector<FrontEdgeId> loop = fronts.LoopOf(fronts.AddLoop(v));
    const auto steps = ProposeClosure(fronts, proposer, loop, kRegardlessOfNormals);
    ASSERT_TRUE(steps);
    ASSERT_EQ(steps->size(), 2u);
    for (const ClosureStep& s : *steps) {
      const Vec3 area = Cross(places[s.apex] - places[s.first], places[s.last] - places[s.first]);
      EXPECT_GT(Norm(area), 0.1) << "begun at " << begin;
    }
  }
}

}  // namespace
}  // namespace meshfront
