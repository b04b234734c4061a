// SHA-256, the checksum of a whole upload.
#pragma once

#include <memory>
#include <string>

#include "absl/strings/string_view.h"

namespace meshfront {

// Usage: Sha256 hash; hash.Update(a); hash.Update(b); end.set_sha256(hash.Finish()); About 1.5 GB/s where the
// processor has the instructions. Not thread-safe.
class Sha256 {
 public:
  Sha256();
  ~Sha256();
  Sha256(const Sha256&) = delete;
  Sha256& operator=(const Sha256&) = delete;

  void Update(absl::string_view data);
  // The 32 bytes of the digest. Once, last.
  std::string Finish();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace meshfront
