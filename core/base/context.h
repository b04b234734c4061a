// What a computation needs from its surroundings: when to stop, whom to tell, how many threads. Values only, no globals.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <string_view>

#include "absl/status/status.h"
#include "absl/time/time.h"

namespace meshfront {

enum class Stage { kRepair, kIndex, kCurvature, kGuidance, kFeatures, kMesh };
std::string_view StageName(Stage stage);  // "repair", "index", … as in the stats

// How far a job is. `triangles` of `predicted_triangles` (0 until the guidance field is known) are settled.
struct Progress {
  Stage stage = Stage::kRepair;
  uint64_t predicted_triangles = 0;
  uint64_t triangles = 0;
  uint64_t open_front_edges = 0;
};

// Handed down by const reference through every stage. `stop` and `deadline` are looked at least once a millisecond.
// Thread-safe: `stop` may be set from any thread; `progress` is called on the thread that runs the job.
struct Context {
  const std::atomic<bool>* stop = nullptr;  // set by the owner to cancel; may be null
  absl::Time deadline = absl::InfiniteFuture();
  std::function<void(const Progress&)> progress;  // may be empty
  int threads = 1;                                // 0 = all cores; the result never depends on it

  // CancelledError when `stop` is set, DeadlineExceededError past the deadline. Reads the clock: 20 ns.
  absl::Status CheckStop() const;
  void Report(const Progress& p) const {
    if (progress) progress(p);
  }
};

// Calls body(begin, end) over a partition of [0, count) in blocks of `grain`, on at most `threads` threads (0 = all cores).
// Which thread runs which block is open, so bodies must write to their own indices only. Stops early, between blocks, when
// `context` says so, and returns that status. An exception of a body ends the loop and never leaves it: ResourceExhausted when
// memory ran out, Internal otherwise. Fewer threads than asked for when the system has no more.
absl::Status ParallelFor(size_t count, size_t grain, const Context& context,
                         const std::function<void(size_t begin, size_t end)>& body);

}  // namespace meshfront
