#include "server/event_stream.h"

#include <gtest/gtest.h>

#include <thread>
#include <vector>

#include "tests/server/fakes.h"

namespace meshfront {
namespace {

// Keeps what is written; by hand, or answering each write at once on the same thread, as gRPC may.
class RecordingWriter : public EventWriter {
 public:
  void StartEvent(v1::MeshEvent event) override {
    {
      std::lock_guard lock(mutex);
      EXPECT_FALSE(ended) << "a write after the end";
      EXPECT_FALSE(outstanding) << "two writes at a time";
      events.push_back(std::move(event));
      outstanding = true;
      changed.notify_all();
    }
    if (immediate) Written();
  }
  void EndCall(const absl::Status& s) override {
    std::lock_guard lock(mutex);
    EXPECT_FALSE(ended) << "two ends";
    status = s;
    ended = true;
    changed.notify_all();
  }
  void Written(bool ok = true) {
    {
      std::lock_guard lock(mutex);
      outstanding = false;
    }
    stream->OnWritten(ok);
  }
  size_t Count() {
    std::lock_guard lock(mutex);
    return events.size();
  }

  EventStream* stream = nullptr;
  bool immediate = false;
  std::mutex mutex;
  std::condition_variable changed;
  std::vector<v1::MeshEvent> events;
  absl::Status status;
  bool outstanding = false, ended = false;
};

struct Fixture {
  explicit Fixture(bool immediate, absl::Duration stall = absl::InfiniteDuration()) : stream(&writer, stall) {
    writer.stream = &stream;
    writer.immediate = immediate;
  }
  RecordingWriter writer;
  EventStream stream;
};

v1::MeshEvent ChunkNumber(uint64_t sequence) {
  v1::MeshEvent event;
  event.mutable_chunk()->set_sequence(sequence);
  return event;
}

v1::MeshEvent AcceptedEvent() {
  v1::MeshEvent event;
  event.mutable_accepted();
  return event;
}

TEST(EventStream, WritesInOrderAndEndsAfterTheLast) {
  Fixture f(/*immediate=*/true);
  f.stream.Open(AcceptedEvent());
  for (int i = 0; i < 100; ++i) ASSERT_TRUE(f.stream.Push(ChunkNumber(i)).ok());
  f.stream.Close(absl::OkStatus());
  ASSERT_EQ(f.writer.events.size(), 101u);
  EXPECT_TRUE(f.writer.events[0].has_accepted());
  for (int i = 0; i < 100; ++i) EXPECT_EQ(f.writer.events[i + 1].chunk().sequence(), static_cast<uint64_t>(i));
  EXPECT_TRUE(f.writer.ended);
  EXPECT_TRUE(f.writer.status.ok());
}

TEST(EventStream, HoldsBackWhatComesBeforeItIsOpen) {
  Fixture f(/*immediate=*/true);
  ASSERT_TRUE(f.stream.Push(ChunkNumber(0)).ok());
  f.stream.SetProgress(v1::Progress());
  EXPECT_EQ(f.writer.Count(), 0u);
  f.stream.Open(AcceptedEvent());
  ASSERT_EQ(f.writer.Count(), 3u);
  EXPECT_TRUE(f.writer.events[0].has_accepted());
  EXPECT_TRUE(f.writer.events[1].has_progress());
  EXPECT_TRUE(f.writer.events[2].has_chunk());
}

TEST(EventStream, HasOneWriteOutstanding) {
  Fixture f(/*immediate=*/false);
  f.stream.Open(AcceptedEvent());
  ASSERT_TRUE(f.stream.Push(ChunkNumber(0)).ok());
  ASSERT_TRUE(f.stream.Push(ChunkNumber(1)).ok());
  EXPECT_EQ(f.writer.Count(), 1u);
  f.writer.Written();
  EXPECT_EQ(f.writer.Count(), 2u);
}

TEST(EventStream, BlocksTheWorkerWhileTheRingIsFull) {
  Fixture f(/*immediate=*/false);
  f.stream.Open(AcceptedEvent());
  for (size_t i = 0; i < EventStream::kSlots; ++i) ASSERT_TRUE(f.stream.Push(ChunkNumber(i)).ok());
  Signal pushed;
  std::thread worker([&] {
    EXPECT_TRUE(f.stream.Push(ChunkNumber(EventStream::kSlots)).ok());
    pushed.Set();
  });
  EXPECT_FALSE(pushed.IsSet());
  f.writer.Written();
  EXPECT_TRUE(pushed.Wait());
  worker.join();
}

TEST(EventStream, AbortsTheWorkerWhenTheReaderTakesNothing) {
  Fixture f(/*immediate=*/false, absl::Milliseconds(1));
  f.stream.Open(AcceptedEvent());
  absl::Status status;
  for (size_t i = 0; i <= EventStream::kSlots && status.ok(); ++i) status = f.stream.Push(ChunkNumber(i));
  EXPECT_EQ(status.code(), absl::StatusCode::kAborted);
}

TEST(EventStream, AbortsTheWorkerWhenTheReaderDoesNotTakeTheLastEvents) {
  Fixture f(/*immediate=*/false, absl::Milliseconds(1));
  f.stream.Open(AcceptedEvent());
  ASSERT_TRUE(f.stream.Push(ChunkNumber(0)).ok());
  EXPECT_EQ(f.stream.Drain().code(), absl::StatusCode::kAborted);
}

TEST(EventStream, EndsAtOnceOnAnErrorThoughAWriteIsOutstanding) {
  Fixture f(/*immediate=*/false);
  f.stream.Open(AcceptedEvent());
  ASSERT_TRUE(f.stream.Push(ChunkNumber(0)).ok());
  f.stream.Close(absl::AbortedError("stalled"));
  EXPECT_TRUE(f.writer.ended);
  EXPECT_EQ(f.writer.status.code(), absl::StatusCode::kAborted);
  f.writer.Written();
  EXPECT_EQ(f.writer.Count(), 1u);
}

TEST(EventStream, WakesABlockedWorkerWhenTheCallIsCancelled) {
  Fixture f(/*immediate=*/false);
  f.stream.Open(AcceptedEvent());
  for (size_t i = 0; i < EventStream::kSlots; ++i) ASSERT_TRUE(f.stream.Push(ChunkNumber(i)).ok());
  absl::Status status;
  std::thread worker([&] { status = f.stream.Push(ChunkNumber(99)); });
  f.stream.Cancel(absl::CancelledError("client"));
  worker.join();
  EXPECT_EQ(status.code(), absl::StatusCode::kCancelled);
  EXPECT_TRUE(f.writer.ended);
  EXPECT_EQ(f.stream.Push(ChunkNumber(100)).code(), absl::StatusCode::kCancelled);
}

TEST(EventStream, EndsWhenAWriteFails) {
  Fixture f(/*immediate=*/false);
  f.stream.Open(AcceptedEvent());
  f.writer.Written(/*ok=*/false);
  EXPECT_TRUE(f.writer.ended);
  EXPECT_EQ(f.writer.status.code(), absl::StatusCode::kCancelled);
}

TEST(EventStream, KeepsTheNewestProgressForASlowReader) {
  Fixture f(/*immediate=*/false);
  f.stream.Open(AcceptedEvent());
  for (int i = 1; i <= 50; ++i) {
    v1::Progress progress;
    progress.set_triangles(i);
    f.stream.SetProgress(progress);
  }
  f.writer.Written();
  f.writer.Written();
  ASSERT_EQ(f.writer.Count(), 2u);
  EXPECT_EQ(f.writer.events[1].progress().triangles(), 50u);
}

TEST(EventStream, WritesEverythingOnceWithAnAnsweringThreadBesideTheWorker) {
  constexpr uint64_t kEvents = 5000;
  Fixture f(/*immediate=*/false);
  std::thread answerer([&] {
    std::unique_lock lock(f.writer.mutex);
    while (true) {
      f.writer.changed.wait(lock, [&] { return f.writer.outstanding || f.writer.ended; });
      if (!f.writer.outstanding) return;
      lock.unlock();
      f.writer.Written();
      lock.lock();
    }
  });
  f.stream.Open(AcceptedEvent());
  for (uint64_t i = 0; i < kEvents; ++i) {
    ASSERT_TRUE(f.stream.Push(ChunkNumber(i)).ok());
    if (i % 7 == 0) f.stream.SetProgress(v1::Progress());
  }
  ASSERT_TRUE(f.stream.Drain().ok());
  f.stream.Close(absl::OkStatus());
  answerer.join();
  uint64_t next = 0;
  for (const v1::MeshEvent& event : f.writer.events) {
    if (!event.has_chunk()) continue;
    EXPECT_EQ(event.chunk().sequence(), next++);
  }
  EXPECT_EQ(next, kEvents);
}

}  // namespace
}  // namespace meshfront
