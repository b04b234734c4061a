// The small parts: pool, gate, leases, addresses, log.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <thread>

#include "proto/wire/errors.h"
#include "server/call_gate.h"
#include "server/config.h"
#include "server/pending_bytes.h"
#include "server/session_result.h"
#include "server/session_store.h"
#include "server/upload_watch.h"
#include "server/worker_pool.h"
#include "tests/server/fakes.h"
#include "tests/support/shapes.h"

namespace meshfront {
namespace {

TEST(WorkerPool, RunsEveryJobItTook) {
  std::atomic<int> ran{0};
  {
    WorkerPool pool(3, 1000);
    for (int i = 0; i < 500; ++i) ASSERT_TRUE(pool.Submit([&] { ++ran; }).ok());
  }
  EXPECT_EQ(ran, 500);
}

TEST(WorkerPool, RefusesWhatItsQueueCannotHoldAndSaysWhenToRetry) {
  Signal started, release;
  WorkerPool pool(1, 1);
  ASSERT_EQ(pool.Submit([&] { started.Set(), release.Wait(); })->position, 0u);
  ASSERT_TRUE(started.Wait());
  EXPECT_EQ(pool.Submit([] {})->position, 1u);
  const absl::Status refused = pool.Submit([] {}).status();
  EXPECT_EQ(refused.code(), absl::StatusCode::kResourceExhausted);
  EXPECT_EQ(ReasonOf(refused).reason, "QUEUE_FULL");
  EXPECT_TRUE(refused.GetPayload("type.googleapis.com/google.rpc.RetryInfo"));
  EXPECT_FALSE(pool.CheckRoom().ok());
  release.Set();
}

TEST(WorkerPool, TakesAJobOutOfTheQueueButNotFromAWorker) {
  Signal started, release;
  bool ran = false;
  {
    WorkerPool pool(1, 8);
    const uint64_t running = pool.Submit([&] { started.Set(), release.Wait(); })->id;
    ASSERT_TRUE(started.Wait());
    const uint64_t waiting = pool.Submit([&] { ran = true; })->id;
    EXPECT_FALSE(pool.Remove(running));
    EXPECT_TRUE(pool.Remove(waiting));
    EXPECT_FALSE(pool.Remove(waiting));
    release.Set();
  }
  EXPECT_FALSE(ran);
}

TEST(CallGate, LetsNobodyInWhileDrainingAndWaitsForThoseInside) {
  CallGate gate;
  ASSERT_TRUE(gate.Enter().ok());
  gate.Drain();
  const absl::Status refused = gate.Enter();
  EXPECT_EQ(refused.code(), absl::StatusCode::kUnavailable);
  EXPECT_EQ(ReasonOf(refused).reason, "DRAINING");
  EXPECT_FALSE(gate.WaitUntilIdle(absl::Milliseconds(1)));
  gate.Leave();
  EXPECT_TRUE(gate.WaitUntilIdle(absl::Seconds(30)));
}

TEST(PendingBytes, AreGivenBackWithTheLease) {
  PendingBytes pending(100);
  {
    PendingBytes::Lease first(pending), second(pending);
    EXPECT_TRUE(first.Hold(60).ok());
    EXPECT_EQ(second.Hold(60).code(), absl::StatusCode::kResourceExhausted);
  }
  PendingBytes::Lease third(pending);
  EXPECT_TRUE(third.Hold(100).ok());
}

TEST(PendingBytes, AreWhatACallHoldsNowAndARefusalTakesNothing) {
  PendingBytes pending(100);
  PendingBytes::Lease first(pending), second(pending);
  ASSERT_TRUE(first.Hold(90).ok());
  EXPECT_FALSE(second.Hold(20).ok());
  EXPECT_TRUE(second.Hold(10).ok());
  ASSERT_TRUE(first.Hold(30).ok());
  EXPECT_TRUE(second.Hold(70).ok());
  EXPECT_EQ(second.held(), 70u);
}

TEST(UploadWatch, AbortsACallThatSendsNothing) {
  struct Writer : EventWriter {
    void StartEvent(v1::MeshEvent) override {}
    void EndCall(const absl::Status& s) override {
      status = s;
      ended.Set();
    }
    absl::Status status;
    Signal ended;
  } writer;
  UploadWatch watch(absl::Milliseconds(5));
  watch.Add(std::make_shared<EventStream>(&writer, absl::InfiniteDuration()));
  ASSERT_TRUE(writer.ended.Wait());
  EXPECT_EQ(writer.status.code(), absl::StatusCode::kAborted);
  EXPECT_EQ(ReasonOf(writer.status).reason, "UPLOAD_STALLED");
}

TEST(IsLoopback, KnowsWhatOtherMachinesReach) {
  for (const char* here : {"127.0.0.1:0", "127.8.9.1:5", "localhost:1", "[::1]:50051", "unix:/tmp/x"})
    EXPECT_TRUE(IsLoopback(here)) << here;
  for (const char* there : {"0.0.0.0:1", "[::]:1", "10.0.0.1:1", "127.evil.example:1", "example.org:1", ":50051"}) {
    EXPECT_FALSE(IsLoopback(there)) << there;
  }
}

std::shared_ptr<const PreparedInput> Ball(int level) {
  return *PreparedInput::Create(testing::Icosphere(level), true, {});
}

TEST(SessionStore, KeepsMeshesUnderNamesOfTheirOwn) {
  SessionStore store({4, 1 << 20, absl::Minutes(1)});
  const auto ball = Ball(2);
  const std::string first = *store.Keep(ball), second = *store.Keep(ball);
  EXPECT_NE(first, second);
  EXPECT_EQ(first.size(), 32u) << "128 random bits";
  EXPECT_EQ(store.Find(first)->input, ball);
  EXPECT_EQ(store.usage().sessions, 2u);
  EXPECT_EQ(store.usage().bytes, 2 * ball->bytes());
  const absl::Status unknown = store.Find("0123").status();
  EXPECT_EQ(unknown.code(), absl::StatusCode::kNotFound);
  EXPECT_EQ(ReasonOf(unknown).reason, "SESSION_UNKNOWN");
}

TEST(SessionStore, ForgetsWhatWasNotUsedForItsTime) {
  absl::Time now = absl::UnixEpoch();
  SessionStore store({4, 1 << 20, absl::Minutes(1)}, [&] { return now; });
  const std::string used = *store.Keep(Ball(1)), idle = *store.Keep(Ball(1));
  now += absl::Seconds(40);
  EXPECT_TRUE(store.Find(used).ok());
  now += absl::Seconds(40);
  EXPECT_TRUE(store.Find(used).ok());
  EXPECT_FALSE(store.Find(idle).ok());
  EXPECT_EQ(store.usage().sessions, 1u);
  now += absl::Seconds(61);
  EXPECT_EQ(store.usage().bytes, 0u);
}

TEST(SessionStore, LetsTheOneThatWasUsedLongestAgoGoFirst) {
  const auto ball = Ball(2);
  SessionStore by_count({2, 1 << 30, absl::Minutes(1)}), by_bytes({9, 2 * ball->bytes(), absl::Minutes(1)});
  for (SessionStore* store : {&by_count, &by_bytes}) {
    const std::string first = *store->Keep(ball), second = *store->Keep(ball);
    EXPECT_TRUE(store->Find(first).ok());
    const std::string third = *store->Keep(ball);
    EXPECT_TRUE(store->Find(first).ok() && store->Find(third).ok());
    EXPECT_FALSE(store->Find(second).ok());
  }
}

TEST(SessionStore, RefusesWhatIsBeyondItsLimitsAlone) {
  SessionStore none({0, 1 << 20, absl::Minutes(1)}), small({4, 1000, absl::Minutes(1)});
  EXPECT_EQ(none.Keep(Ball(1)).status().code(), absl::StatusCode::kResourceExhausted);
  EXPECT_EQ(small.Keep(Ball(2)).status().code(), absl::StatusCode::kResourceExhausted);
  EXPECT_EQ(small.usage().sessions, 0u);
}

TEST(SessionStore, ReplacesTheMeshThatIsMeant) {
  SessionStore store({4, 1 << 20, absl::Minutes(1)});
  const auto first = Ball(1), second = Ball(2);
  const std::string name = *store.Keep(first);
  EXPECT_EQ(store.Find(name)->revision, 0u);
  EXPECT_EQ(*store.Replace(name, 0, second), 1u);
  EXPECT_EQ(store.Find(name)->input, second);
  EXPECT_EQ(store.Find(name)->revision, 1u);
  EXPECT_EQ(store.usage().bytes, second->bytes());
  const absl::Status late = store.Replace(name, 0, first).status();  // of what another call saw before
  EXPECT_EQ(late.code(), absl::StatusCode::kAborted);
  EXPECT_EQ(ReasonOf(late).reason, "SESSION_CHANGED");
  EXPECT_THAT(late.message(), ::testing::HasSubstr("was replaced, and is at 1 now"));
  const absl::Status early = store.Replace(name, 2, first).status();
  EXPECT_EQ(ReasonOf(early).reason, "SESSION_CHANGED");
  EXPECT_THAT(early.message(), ::testing::HasSubstr("was not replaced so often, and is at 1 now"));
  EXPECT_EQ(store.Find(name)->input, second);
  EXPECT_EQ(store.Replace("0123", 0, first).status().code(), absl::StatusCode::kNotFound);
}

TEST(SessionStore, MakesRoomForWhatReplaces) {
  const auto small = Ball(1), large = Ball(3);
  SessionStore store({4, large->bytes() + small->bytes(), absl::Minutes(1)});
  const std::string oldest = *store.Keep(small), grown = *store.Keep(small), newest = *store.Keep(small);
  EXPECT_EQ(*store.Replace(grown, 0, large), 1u);
  EXPECT_FALSE(store.Find(oldest).ok());
  EXPECT_TRUE(store.Find(newest).ok() && store.Find(grown).ok());
  EXPECT_EQ(store.usage().bytes, large->bytes() + small->bytes());
  const absl::Status beyond = store.Replace(newest, 0, Ball(4)).status();
  EXPECT_EQ(beyond.code(), absl::StatusCode::kResourceExhausted);
  EXPECT_EQ(ReasonOf(beyond).reason, "SESSION_TOO_LARGE");
  EXPECT_EQ(store.Find(newest)->input, small);
}

// A sphere in two pieces, of which the store can keep the first.
TEST(SessionResult, LetsGoOfWhatCannotBeKept) {
  const TriangleMesh ball = testing::Icosphere(2);
  const SessionStore store({4, Ball(2)->bytes(), absl::Minutes(1)});
  std::vector<OutputVertex> vertices;
  for (const Vec3& p : ball.positions) vertices.push_back({p, Vec3{0, 0, 1}});
  const OutputVertex one_more[] = {{Vec3{}, Vec3{}}};
  SessionResult result(store);
  EXPECT_TRUE(result.Append({.vertices = vertices, .triangles = ball.triangles}).ok());
  EXPECT_TRUE(result.status().ok()) << "it fits to the byte";
  SessionResult too_large(store);
  EXPECT_TRUE(too_large.Append({.vertices = vertices, .triangles = ball.triangles}).ok());
  EXPECT_TRUE(too_large.Append({.vertices = one_more}).ok());
  EXPECT_EQ(ReasonOf(too_large.status()).reason, "SESSION_TOO_LARGE");
  EXPECT_TRUE(too_large.Append({.vertices = vertices}).ok());
  EXPECT_TRUE(too_large.Take().positions.empty());
  const TriangleMesh kept = result.Take();
  EXPECT_EQ(kept.positions, ball.positions);
  EXPECT_TRUE(kept.normals.empty());
}

TEST(SessionResult, BelievesPredictionsOnlySoFar) {
  const SessionStore store({4, Ball(3)->bytes(), absl::Minutes(1)});
  const SessionResult result(store);
  const uint64_t fits = testing::Icosphere(3).triangles.size();
  EXPECT_TRUE(result.CheckPrediction(fits).ok());
  EXPECT_TRUE(result.CheckPrediction(fits * 2).ok()) << "it may be off";
  EXPECT_EQ(ReasonOf(result.CheckPrediction(fits * 5 / 2)).reason, "SESSION_TOO_LARGE");
}

TEST(SessionStore, IsSafeToUseFromManyThreads) {
  SessionStore store({3, 1 << 20, absl::Minutes(1)});
  const auto ball = Ball(1);
  std::vector<std::thread> threads;
  for (int i = 0; i < 4; ++i) {
    threads.emplace_back([&] {
      for (int round = 0; round < 50; ++round) (void)store.Find(*store.Keep(ball));
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(store.usage().sessions, 3u);
}

}  // namespace
}  // namespace meshfront
