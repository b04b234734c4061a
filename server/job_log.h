// The job log: one line of JSON per job.
#pragma once

#include <cstdio>
#include <memory>
#include <mutex>
#include <string>

#include <nlohmann/json.hpp>

#include "absl/status/statusor.h"

namespace meshfront {

// Thread-safe; a line is written whole.
class JobLog {
 public:
  // `destination`: a file, which is appended to; empty: stderr; "off": nothing. NotFound when the file can't be opened.
  static absl::StatusOr<std::unique_ptr<JobLog>> Create(const std::string& destination);
  ~JobLog();

  void Write(const nlohmann::ordered_json& line);

 private:
  explicit JobLog(std::FILE* file) : file_(file) {}

  std::mutex mutex_;
  std::FILE* file_;  // null: nothing is written
};

}  // namespace meshfront
