#include "core/base/context.h"

#include <algorithm>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

#include "absl/time/clock.h"
#include "core/base/exceptions.h"

namespace meshfront {

std::string_view StageName(Stage stage) {
  switch (stage) {
    case Stage::kRepair:
      return "repair";
    case Stage::kIndex:
      return "index";
    case Stage::kCurvature:
      return "curvature";
    case Stage::kGuidance:
      return "guidance";
    case Stage::kFeatures:
      return "features";
    case Stage::kMesh:
      return "mesh";
  }
  return "unknown";
}

absl::Status Context::CheckStop() const {
  if (stop != nullptr && stop->load(std::memory_order_relaxed)) return absl::CancelledError("the job was cancelled");
  if (deadline != absl::InfiniteFuture() && absl::Now() > deadline) {
    return absl::DeadlineExceededError("the deadline passed before the job was done");
  }
  return absl::OkStatus();
}

absl::Status ParallelFor(size_t count, size_t grain, const Context& context,
                         const std::function<void(size_t begin, size_t end)>& body) {
  const size_t blocks = (count + grain - 1) / grain;
  size_t threads = context.threads > 0 ? context.threads : std::max(1u, std::thread::hardware_concurrency());
  threads = std::min(threads, blocks);
  std::atomic<size_t> next{0};
  std::atomic<bool> stopped{false};
  std::mutex mutex;
  std::exception_ptr thrown;  // the first
  auto work = [&]() noexcept {
    try {
      for (size_t block = next++; block < blocks && !stopped; block = next++) {
        if (!context.CheckStop().ok())
          stopped = true;
        else
          body(block * grain, std::min(count, (block + 1) * grain));
      }
    } catch (...) {
      stopped = true;
      const std::lock_guard<std::mutex> lock(mutex);
      if (!thrown) thrown = std::current_exception();
    }
  };
  std::vector<std::thread> helpers;
  try {
    for (size_t i = 1; i < threads; ++i) helpers.emplace_back(work);
  } catch (const std::exception&) {
    // No room for one more thread: those that are there do the work.
  }
  work();
  for (std::thread& helper : helpers) helper.join();
  if (thrown) return StatusOf(thrown);
  return stopped ? context.CheckStop() : absl::OkStatus();
}

}  // namespace meshfront
