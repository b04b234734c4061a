// Ends calls whose upload stands still, so that an idle client holds no memory and no drain.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <thread>

#include "absl/time/time.h"
#include "server/event_stream.h"

namespace meshfront {

// Thread-safe. One thread, which sleeps until the oldest upload would be due.
class UploadWatch {
 public:
  explicit UploadWatch(absl::Duration timeout);
  ~UploadWatch();

  // From now on the call is closed with Aborted when it was not touched for the timeout.
  uint64_t Add(std::shared_ptr<EventStream> events);
  void Touch(uint64_t id);
  void Remove(uint64_t id);

 private:
  struct Entry {
    std::shared_ptr<EventStream> events;
    absl::Time touched;
  };
  void Watch();
  void End(EventStream& events) const;

  const absl::Duration timeout_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::map<uint64_t, Entry> entries_;
  uint64_t next_id_ = 1;
  bool stopping_ = false;
  std::thread thread_;
};

}  // namespace meshfront
