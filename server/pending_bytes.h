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

  // What one call has taken; given back when it is destroyed.
  class Lease {
   public:
    explicit Lease(PendingBytes& owner) : owner_(owner) {}
    Lease(const Lease&) = delete;
    Lease& operator=(const Lease&) = delete;
    ~Lease() { owner_.used_ -= taken_; }

    // ResourceExhausted with RetryInfo when the server holds too much already.
    absl::Status Take(uint64_t bytes) {
      taken_ += bytes;
      if ((owner_.used_ += bytes) <= owner_.limit_) return absl::OkStatus();
      return WithRetry(
          WithReason(absl::ResourceExhaustedError(absl::StrCat("the uploads of all callers together exceed ",
                                                               owner_.limit_, " bytes; try again later")),
                     "MEMORY_FULL", {{"limit", absl::StrCat(owner_.limit_)}}),
          absl::Seconds(2));
    }

   private:
    PendingBytes& owner_;
    uint64_t taken_ = 0;
  };

 private:
  const uint64_t limit_;
  std::atomic<uint64_t> used_{0};
};

}  // namespace meshfront
