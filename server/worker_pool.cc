#include "server/worker_pool.h"

#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "proto/wire/errors.h"

namespace meshfront {

WorkerPool::WorkerPool(int workers, int max_queue)
    : workers_(std::max(1, workers)), max_queue_(std::max(0, max_queue)) {
  try {
    for (size_t i = 0; i < workers_; ++i) threads_.emplace_back([this] { Work(); });
  } catch (...) {  // no room for their stacks: nobody is left waiting for the threads that did start
    Stop();
    throw;
  }
}

WorkerPool::~WorkerPool() { Stop(); }

void WorkerPool::Stop() {
  {
    std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  changed_.notify_all();
  for (std::thread& thread : threads_) thread.join();
}

absl::Status WorkerPool::CheckRoomLocked() const {
  // Idle workers will take as many of the queue at once.
  if (queue_.size() < max_queue_ + (workers_ - running_)) return absl::OkStatus();
  const absl::Duration delay = absl::Seconds(1) + absl::Milliseconds(250) * static_cast<double>(queue_.size());
  return WithRetry(
      WithReason(absl::ResourceExhaustedError(absl::StrCat("all ", workers_, " workers are busy and ", queue_.size(),
                                                           " jobs wait; try again later")),
                 "QUEUE_FULL", {{"queued", absl::StrCat(queue_.size())}, {"limit", absl::StrCat(max_queue_)}}),
      std::min(delay, absl::Seconds(30)));
}

absl::Status WorkerPool::CheckRoom() const {
  std::lock_guard lock(mutex_);
  return CheckRoomLocked();
}

absl::StatusOr<WorkerPool::Ticket> WorkerPool::Submit(std::function<void()> job) {
  Ticket ticket;
  {
    std::lock_guard lock(mutex_);
    if (absl::Status status = CheckRoomLocked(); !status.ok()) return status;
    const size_t idle = workers_ - running_;
    ticket = {next_id_++, static_cast<uint32_t>(queue_.size() < idle ? 0 : queue_.size() - idle + 1)};
    queue_.push_back({ticket.id, std::move(job)});
  }
  changed_.notify_one();
  return ticket;
}

WorkerPool::Load WorkerPool::load() const {
  std::lock_guard lock(mutex_);
  return {running_, queue_.size()};
}

bool WorkerPool::Remove(uint64_t id) {
  std::function<void()> dropped;  // destroyed after the lock: it may own much
  std::lock_guard lock(mutex_);
  const auto found = std::find_if(queue_.begin(), queue_.end(), [id](const Entry& e) { return e.id == id; });
  if (found == queue_.end()) return false;
  dropped = std::move(found->job);
  queue_.erase(found);
  return true;
}

void WorkerPool::Work() {
  std::unique_lock lock(mutex_);
  while (true) {
    changed_.wait(lock, [this] { return stopping_ || !queue_.empty(); });
    if (queue_.empty()) return;
    std::function<void()> job = std::move(queue_.front().job);
    queue_.pop_front();
    ++running_;
    lock.unlock();
    job();
    job = nullptr;
    lock.lock();
    --running_;
  }
}

}  // namespace meshfront
