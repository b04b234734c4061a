// The threads that run jobs, and the bounded queue before them.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

#include "absl/status/statusor.h"

namespace meshfront {

// First in, first out. Thread-safe.
class WorkerPool {
 public:
  struct Ticket {
    uint64_t id = 0;
    uint32_t position = 0;  // jobs that go first; 0: it starts at once
  };

  WorkerPool(int workers, int max_queue);
  // Runs what is queued to its end.
  ~WorkerPool();

  // ResourceExhausted with RetryInfo when all workers are busy and the queue is full.
  absl::StatusOr<Ticket> Submit(std::function<void()> job);
  // The same refusal, before anything is uploaded.
  absl::Status CheckRoom() const;
  struct Load {
    size_t running = 0, queued = 0;
  };
  Load load() const;
  // Takes a job out of the queue; false when it was started already.
  bool Remove(uint64_t id);

 private:
  struct Entry {
    uint64_t id;
    std::function<void()> job;
  };
  void Work();
  void Stop();
  absl::Status CheckRoomLocked() const;

  const size_t workers_;
  const size_t max_queue_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Entry> queue_;
  size_t running_ = 0;
  uint64_t next_id_ = 1;
  bool stopping_ = false;
  std::vector<std::thread> threads_;
};

}  // namespace meshfront
