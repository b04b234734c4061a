#include "core/mesh/holding_sink.h"

#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/support/matchers.h"

namespace meshfront {
namespace {

using meshfront::testing::IsOk;
using meshfront::testing::StatusIs;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

// Notes how many triangles came with each piece, and keeps all.
class NotingSink : public MeshSink {
 public:
  absl::Status Append(const MeshPiece& piece) override {
    sizes.push_back(piece.triangles.size());
    last_open_front_edges = piece.open_front_edges;
    kinds.insert(kinds.end(), piece.kinds.begin(), piece.kinds.end());
    return sizes.size() > accepted ? absl::ResourceExhaustedError("full") : collected.Append(piece);
  }
  std::vector<size_t> sizes;
  std::vector<TriangleKind> kinds;
  uint64_t last_open_front_edges = 0;
  size_t accepted = 100;
  CollectingSink collected;
};

// A piece of `count` triangles that gives its memory back at once.
absl::Status Append(MeshSink& sink, uint32_t count, double x = 0) {
  std::vector<OutputVertex> vertices;
  std::vector<Triangle> triangles;
  std::vector<TriangleKind> kinds(count, TriangleKind::kConnection);
  for (uint32_t i = 0; i < count; ++i) {
    vertices.push_back({{x, 1.0 * i, 0}, {0, 0, 1}});
    triangles.push_back({VertexId(0), VertexId(1), VertexId(2)});
  }
  const std::vector<VertexId> finalised = {VertexId(count - 1)};
  return sink.Append({vertices, triangles, finalised, 10 * count, kinds});
}

TEST(HoldingSink, HoldsUntilItIsReleased) {
  NotingSink next;
  HoldingSink held(next, 100);
  EXPECT_THAT(Append(held, 3, 7), IsOk());
  EXPECT_THAT(Append(held, 5), IsOk());
  EXPECT_THAT(next.sizes, IsEmpty());
  EXPECT_FALSE(held.is_passing());
  EXPECT_THAT(held.Release(), IsOk());
  EXPECT_THAT(next.sizes, ElementsAre(3, 5));
  EXPECT_EQ(next.collected.mesh.positions[2], (Vec3{7, 2, 0}));
  EXPECT_THAT(next.collected.finalised, ElementsAre(VertexId(2), VertexId(4)));
  EXPECT_EQ(next.kinds.size(), 8u);
  EXPECT_EQ(next.last_open_front_edges, 50u);
  EXPECT_TRUE(held.is_passing());
}

TEST(HoldingSink, PassesAllOnInOrderBeyondItsLimit) {
  NotingSink next;
  HoldingSink held(next, 10);
  EXPECT_THAT(Append(held, 4), IsOk());
  EXPECT_THAT(Append(held, 6), IsOk());
  EXPECT_THAT(next.sizes, IsEmpty()) << "just as many as it may hold";
  EXPECT_THAT(Append(held, 1), IsOk());
  EXPECT_THAT(next.sizes, ElementsAre(4, 6, 1));
  EXPECT_TRUE(held.is_passing());
  EXPECT_THAT(Append(held, 2), IsOk());
  EXPECT_THAT(next.sizes, ElementsAre(4, 6, 1, 2)) << "no longer held";
}

TEST(HoldingSink, HoldsNothingWithoutALimit) {
  NotingSink next;
  HoldingSink held(next, 0);
  EXPECT_THAT(Append(held, 1), IsOk());
  EXPECT_THAT(next.sizes, ElementsAre(1));
}

TEST(HoldingSink, ForgetsWhatIsTakenAndCountsAnew) {
  NotingSink next;
  HoldingSink held(next, 10);
  EXPECT_THAT(Append(held, 8, 1), IsOk());
  std::vector<HeldPiece> first = held.Take();
  EXPECT_THAT(Append(held, 9, 2), IsOk());
  EXPECT_THAT(next.sizes, IsEmpty());
  held.Take();
  held.PutBack(std::move(first));
  EXPECT_THAT(held.Release(), IsOk());
  EXPECT_THAT(next.sizes, ElementsAre(8));
  EXPECT_EQ(next.collected.mesh.positions[0].x, 1);
}

TEST(HoldingSink, HoldsAllOnceItIsToldTo) {
  NotingSink next;
  HoldingSink held(next, 10);
  EXPECT_THAT(Append(held, 8), IsOk());
  held.Take();
  held.HoldAll();
  EXPECT_THAT(Append(held, 80), IsOk());
  EXPECT_THAT(next.sizes, IsEmpty());
  EXPECT_FALSE(held.is_passing());
}

TEST(HoldingSink, HandsTheNextOnesErrorOn) {
  NotingSink next;
  next.accepted = 1;
  HoldingSink held(next, 10);
  EXPECT_THAT(Append(held, 4), IsOk());
  EXPECT_THAT(Append(held, 4), IsOk());
  EXPECT_THAT(Append(held, 4), StatusIs(absl::StatusCode::kResourceExhausted, "full"));
}

}  // namespace
}  // namespace meshfront
