#include "server/job_log.h"

#include <cerrno>

#include "absl/strings/str_cat.h"

namespace meshfront {

absl::StatusOr<std::unique_ptr<JobLog>> JobLog::Create(const std::string& destination) {
  if (destination == "off") return std::unique_ptr<JobLog>(new JobLog(nullptr));
  if (destination.empty() || destination == "-") return std::unique_ptr<JobLog>(new JobLog(stderr));
  std::FILE* file = std::fopen(destination.c_str(), "ae");
  if (file == nullptr) return absl::ErrnoToStatus(errno, absl::StrCat("the log ", destination, " can't be opened"));
  return std::unique_ptr<JobLog>(new JobLog(file));
}

JobLog::~JobLog() {
  if (file_ != nullptr && file_ != stderr) std::fclose(file_);
}

void JobLog::Write(const nlohmann::ordered_json& line) {
  if (file_ == nullptr) return;
  // What clients send may hold anything: bytes that are not UTF-8 are replaced, control characters escaped.
  const std::string text = line.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
  std::lock_guard lock(mutex_);
  std::fwrite(text.data(), 1, text.size(), file_);
  std::fflush(file_);
}

}  // namespace meshfront
