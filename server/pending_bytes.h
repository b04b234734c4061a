// The memory that uploads of all calls take together, bounded.
#pragma once

#include <atomic>
#include <cstdint>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "proto/wire/errors.h"

namespace meshfront {

// Thread-safe.
class PendingBytes {
 public:
  explicit PendingBytes(uint64_t limit) : limit_(limit) {}

  // What one call holds; given back when it is destroyed. One thread at a time.
  class Lease {
   public:
    explicit Lease(PendingBytes& owner) : owner_(owner) {}
    Lease(const Lease&) = delete;
    Lease& operator=(const Lease&) = delete;
    ~Lease() { owner_.used_ -= taken_; }

    // From now on the call holds `bytes` in all, more than before or less. ResourceExhausted with RetryInfo when all calls
    // together would exceed the limit; then it holds what it held.
    absl::Status Hold(uint64_t bytes) {
      const uint64_t more = bytes > taken_ ? bytes - taken_ : 0;
      if (more == 0 || (owner_.used_ += more) <= owner_.limit_) {
        if (bytes < taken_) owner_.used_ -= taken_ - bytes;
        taken_ = bytes;
        return absl::OkStatus();
      }
      owner_.used_ -= more;
      return WithRetry(
          WithReason(absl::ResourceExhaustedError(absl::StrCat("the uploads of all callers together exceed ",
                                                               owner_.limit_, " bytes; try again later")),
                     "MEMORY_FULL", {{"limit", absl::StrCat(owner_.limit_)}}),
          absl::Seconds(2));
    }
    uint64_t held() const { return taken_; }

   private:
    PendingBytes& owner_;
    uint64_t taken_ = 0;
  };

 private:
  const uint64_t limit_;
  std::atomic<uint64_t> used_{0};
};

}  // namespace meshfront
