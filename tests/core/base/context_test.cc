// Loops over many threads: what stops them, and what an exception becomes.
#include "core/base/context.h"

#include <algorithm>
#include <atomic>
#include <new>
#include <numeric>
#include <stdexcept>
#include <vector>

#include "core/base/exceptions.h"
#include "tests/support/matchers.h"

namespace meshfront {
namespace {

using testing::IsOk;
using testing::StatusIs;

Context WithThreads(int threads) {
  Context context;
  context.threads = threads;
  return context;
}

TEST(ParallelFor, RunsEveryBlockOnce) {
  for (const int threads : {1, 4, 100}) {
    std::vector<int> runs(1003, 0);
    ASSERT_THAT(ParallelFor(runs.size(), 10, WithThreads(threads),
                            [&](size_t begin, size_t end) {
                              for (size_t i = begin; i < end; ++i) ++runs[i];
                            }),
                IsOk());
    EXPECT_EQ(std::accumulate(runs.begin(), runs.end(), 0), 1003);
    EXPECT_EQ(*std::max_element(runs.begin(), runs.end()), 1);
  }
}

TEST(ParallelFor, TurnsAnExceptionOfAnyThreadIntoAStatusWhenAllThreadsHaveEnded) {
  for (const int threads : {1, 4}) {
    for (const bool memory : {true, false}) {
      std::atomic<int> inside{0};
      const absl::Status status = ParallelFor(64, 1, WithThreads(threads), [&](size_t begin, size_t) {
        ++inside;
        struct Leave {
          std::atomic<int>& inside;
          ~Leave() { --inside; }
        } leave{inside};
        if (begin % 3 != 1) return;
        if (memory) throw std::bad_alloc();
        throw std::runtime_error("a broken body");
      });
      EXPECT_EQ(inside, 0);
      if (memory)
        EXPECT_THAT(status, StatusIs(absl::StatusCode::kResourceExhausted, "not enough memory"));
      else
        EXPECT_THAT(status, StatusIs(absl::StatusCode::kInternal, "a broken body"));
      EXPECT_EQ(IsOutOfMemory(status), memory);
    }
  }
}

TEST(ParallelFor, StopsWhenItIsToldTo) {
  const std::atomic<bool> stop{true};
  Context context = WithThreads(4);
  context.stop = &stop;
  EXPECT_THAT(ParallelFor(100, 1, context, [](size_t, size_t) { FAIL(); }), StatusIs(absl::StatusCode::kCancelled, ""));
}

TEST(Exceptions, TellMemoryFromLimitsAndFaults) {
  EXPECT_FALSE(IsOutOfMemory(absl::ResourceExhaustedError("beyond a limit")));
  EXPECT_TRUE(IsOutOfMemory(StatusOf(std::make_exception_ptr(std::length_error("vector")))));
  EXPECT_THAT(StatusOf(std::make_exception_ptr(7)), StatusIs(absl::StatusCode::kInternal, "unknown"));
}

}  // namespace
}  // namespace meshfront
