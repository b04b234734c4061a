#include "core/features/close_curves.h"

#include <atomic>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>

#include "core/features/boundary.h"
#include "core/features/creases.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/support/matchers.h"
#include "tests/support/shapes.h"

namespace meshfront {
namespace {

using meshfront::testing::CappedCylinder;
using meshfront::testing::Cube;
using meshfront::testing::DiskWithHoles;
using meshfront::testing::Icosphere;
using meshfront::testing::IsOk;
using meshfront::testing::Joined;
using meshfront::testing::Moved;
using meshfront::testing::OpenCylinder;
using meshfront::testing::Sheet;

// With edges of one length everywhere.
bool IsClose(const TriangleMesh& mesh, double length, bool with_creases = false) {
  FaceAdjacency adjacency = CreateAdjacency(mesh);
  std::vector<bool> creases(3 * mesh.triangles.size(), false);
  if (with_creases) creases = *FindCreases(mesh, adjacency, 40 * std::numbers::pi / 180, Context{});
  const auto surface = MeshSurface::Create(mesh, std::move(adjacency), creases, Context{});
  EXPECT_THAT(surface, IsOk());
  const GuidanceField field = *GuidanceField::Create({}, {1.2, 0, length}, Context{});
  const auto loops = BoundaryLoops(**surface, field, {}, Context{});
  EXPECT_THAT(loops, IsOk());
  const absl::StatusOr<bool> is_close = DoCurvesLieClose(**surface, *loops, Context{});
  EXPECT_THAT(is_close, IsOk());
  return *is_close;
}

TEST(DoCurvesLieClose, NotWhereThereAreNone) { EXPECT_FALSE(IsClose(Icosphere(3), 0.3)); }

TEST(DoCurvesLieClose, NotToTheSurfaceThatTheyBound) {
  EXPECT_FALSE(IsClose(Sheet(20), 0.2));
  EXPECT_FALSE(IsClose(OpenCylinder(1, 2, 96, 24), 0.5));
  EXPECT_FALSE(IsClose(DiskWithHoles(40), 0.05));
}

TEST(DoCurvesLieClose, ToAnotherPartWithinHalfAnEdge) {
  const TriangleMesh tube = OpenCylinder(1, 2, 96, 24);
  EXPECT_TRUE(IsClose(Joined(tube, CappedCylinder(0.9, 3, 96, 32)), 0.5));
  EXPECT_FALSE(IsClose(Joined(tube, CappedCylinder(0.9, 3, 96, 32)), 0.1)) << "shorter edges do not reach so far";
  EXPECT_FALSE(IsClose(Joined(tube, Moved(tube, {5, 0, 0})), 0.5));
}

// A rim with deep notches: a walk along it ends in one, but the faces lead around.
TEST(DoCurvesLieClose, NotBehindANotch) {
  TriangleMesh sheet = Sheet(40);
  std::erase_if(sheet.triangles, [&](const Triangle& t) {
    const Vec3 middle = (sheet.PositionAt(t[0]) + sheet.PositionAt(t[1]) + sheet.PositionAt(t[2])) / 3.0;
    return middle.y > 0.7 && std::fmod(middle.x + 2, 0.4) < 0.1;
  });
  EXPECT_FALSE(IsClose(meshfront::testing::WithoutUnreferenced(sheet), 0.05));
}

TEST(DoCurvesLieClose, StopsWhenItIsTold) {
  const auto surface = MeshSurface::Create(Sheet(100), Context{});
  ASSERT_THAT(surface, IsOk());
  const GuidanceField field = *GuidanceField::Create({}, {1.2, 0, 0.1}, Context{});
  const auto loops = BoundaryLoops(**surface, field, {}, Context{});
  const std::atomic<bool> stop = true;
  Context context;
  context.stop = &stop;
  EXPECT_EQ(DoCurvesLieClose(**surface, *loops, context).status().code(), absl::StatusCode::kCancelled);
}

TEST(DoCurvesLieClose, AlwaysOnCreases) { EXPECT_TRUE(IsClose(Cube(4), 0.3, true)); }

}  // namespace
}  // namespace meshfront
