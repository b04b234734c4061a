// How a job ends before its end: cancelled, too late, or because nobody takes the result.
#include <atomic>
#include <vector>

#include "core/remesh.h"
#include "tests/support/matchers.h"
#include "tests/support/shapes.h"

namespace meshfront::testing {
namespace {

// Takes `accepted` pieces, then calls `then` for every further one.
class SinkThat : public MeshSink {
 public:
  SinkThat(int accepted, std::function<absl::Status()> then) : accepted_(accepted), then_(std::move(then)) {}
  absl::Status Append(const MeshPiece& piece) override {
    ++pieces;
    triangles += piece.triangles.size();
    return pieces > accepted_ ? then_() : absl::OkStatus();
  }
  int pieces = 0;
  size_t triangles = 0;

 private:
  int accepted_;
  std::function<absl::Status()> then_;
};

// A sphere of about 43,000 triangles, more than any working area holds.
Problem ManyTriangles() {
  Problem problem{Icosphere(5), {}};
  problem.options.rho = 0.03;
  return problem;
}

TEST(RemeshStop, DoesNotStartWhenCancelledBefore) {
  const std::atomic<bool> stop = true;
  Context context;
  context.stop = &stop;
  CollectingSink sink;
  EXPECT_THAT(Remesh(ManyTriangles(), sink, context), StatusIs(absl::StatusCode::kCancelled, ""));
  EXPECT_TRUE(sink.mesh.triangles.empty());
}

TEST(RemeshStop, StopsAfterAtMostOnePieceWhenCancelledMidway) {
  std::atomic<bool> stop = false;
  Context context;
  context.stop = &stop;
  SinkThat sink(3, [&] {
    stop = true;
    return absl::OkStatus();
  });
  EXPECT_THAT(Remesh(ManyTriangles(), sink, context), StatusIs(absl::StatusCode::kCancelled, ""));
  EXPECT_GE(sink.pieces, 4);
  EXPECT_LE(sink.pieces, 5);
}

TEST(RemeshStop, TurnsExceptionsIntoStatuses) {
  SinkThat full(0, []() -> absl::Status { throw std::bad_alloc(); });
  EXPECT_THAT(Remesh(ManyTriangles(), full, {}), StatusIs(absl::StatusCode::kResourceExhausted, "not enough memory"));
}

TEST(RemeshStop, StopsInEveryStage) {
  std::vector<Stage> stages;
  {
    Context context;
    context.progress = [&](const Progress& p) {
      if (stages.empty() || stages.back() != p.stage) stages.push_back(p.stage);
    };
    CollectingSink sink;
    ASSERT_THAT(Remesh({DiskWithHoles(), {}}, sink, context), IsOk());
  }
  ASSERT_GE(stages.size(), 3u);
  for (const Stage stage : stages) {
    SCOPED_TRACE(std::string(StageName(stage)));
    std::atomic<bool> stop = false;
    Context context;
    context.stop = &stop;
    context.progress = [&](const Progress& p) { stop = stop || p.stage == stage; };
    CollectingSink sink;
    EXPECT_THAT(Remesh({DiskWithHoles(), {}}, sink, context), StatusIs(absl::StatusCode::kCancelled, ""));
  }
}

TEST(RemeshStop, KeepsTheDeadline) {
  Context context;
  context.deadline = absl::InfinitePast();
  CollectingSink sink;
  EXPECT_THAT(Remesh(ManyTriangles(), sink, context), StatusIs(absl::StatusCode::kDeadlineExceeded, ""));
}

TEST(RemeshStop, EndsWithTheSinksOwnStatusAndLeavesItAlone) {
  SinkThat sink(2, [] { return absl::ResourceExhaustedError("the disk is full"); });
  EXPECT_THAT(Remesh(ManyTriangles(), sink, {}), StatusIs(absl::StatusCode::kResourceExhausted, "the disk is full"));
  EXPECT_EQ(sink.pieces, 3);
}

TEST(RemeshProgress, GoesThroughTheStagesInOrderAndCountsUp) {
  std::vector<Progress> seen;
  Context context;
  context.progress = [&](const Progress& p) { seen.push_back(p); };
  CollectingSink sink;
  const absl::StatusOr<Report> report = Remesh(ManyTriangles(), sink, context);
  ASSERT_THAT(report, IsOk());
  ASSERT_FALSE(seen.empty());
  for (size_t i = 1; i < seen.size(); ++i) {
    EXPECT_GE(seen[i].stage, seen[i - 1].stage);
    EXPECT_GE(seen[i].triangles, seen[i - 1].triangles);
  }
  EXPECT_EQ(seen.back().stage, Stage::kMesh);
  EXPECT_EQ(seen.back().predicted_triangles, report->predicted_triangles);
  EXPECT_LE(seen.back().triangles, sink.mesh.triangles.size());
}

TEST(RemeshStream, SendsTrianglesLongBeforeTheEnd) {
  // No piece holds more than a quarter of the result: it is not held back.
  std::vector<size_t> triangles_at_piece;
  SinkThat sink(0, [&] {
    triangles_at_piece.push_back(sink.triangles);
    return absl::OkStatus();
  });
  ASSERT_THAT(Remesh(ManyTriangles(), sink, {}), IsOk());
  ASSERT_GE(triangles_at_piece.size(), 5u);
  size_t largest = triangles_at_piece.front();
  for (size_t i = 1; i < triangles_at_piece.size(); ++i) {
    largest = std::max(largest, triangles_at_piece[i] - triangles_at_piece[i - 1]);
  }
  EXPECT_LE(largest, sink.triangles / 4);
}

TEST(RemeshEstimate, PredictsWithoutMeshing) {
  const absl::StatusOr<Estimate> estimate = EstimateRemesh({Icosphere(4), {}}, {});
  ASSERT_THAT(estimate, IsOk());
  CollectingSink sink;
  const absl::StatusOr<Report> report = Remesh({Icosphere(4), {}}, sink, {});
  ASSERT_THAT(report, IsOk());
  EXPECT_EQ(estimate->predicted_triangles, report->predicted_triangles);
  EXPECT_GT(estimate->error_bound, 0.5 * report->error_bound);
  EXPECT_LT(estimate->error_bound, 2 * report->error_bound);
  EXPECT_GT(estimate->edge_min, 0);
  EXPECT_LE(estimate->edge_min, estimate->edge_median);
  EXPECT_LE(estimate->edge_median, estimate->edge_max);
  EXPECT_GT(estimate->memory_bytes, 0u);
}

}  // namespace
}  // namespace meshfront::testing
