#include "client/cli/call_failure.h"

#include <cmath>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "proto/wire/errors.h"

namespace meshfront {
namespace {

absl::Status WithPrefix(const std::string& prefix, const absl::Status& status) {
  if (absl::StartsWith(status.message(), prefix)) return status;
  return absl::Status(status.code(), absl::StrCat(prefix, ": ", status.message()));
}

}  // namespace

ExitCode FailCall(const absl::Status& status, const CalledWith& called_with) {
  const ExitCode code = ExitCodeOfCall(status);
  const bool remote = !called_with.server.empty();
  const std::string reason = ReasonOf(status).reason;
  // gRPC's own texts say neither what nor how long.
  if (absl::IsDeadlineExceeded(status) && reason != "JOB_TIME_LIMIT" && std::isfinite(called_with.timeout)) {
    return Fail(code, absl::DeadlineExceededError(
                          absl::StrCat("the call took longer than --timeout ", called_with.timeout, " s")));
  }
  if (absl::IsCancelled(status)) return Fail(code, absl::CancelledError("cancelled"));
  if (code == ExitCode::kInput)
    return Fail(code, WithPrefix(called_with.in == "-" ? "standard input" : called_with.in, status));
  if (!remote && reason == "OUT_OF_MEMORY") return Fail(ExitCode::kInternalError, status);
  if (remote && (code == ExitCode::kServer || code == ExitCode::kCancelled || code == ExitCode::kInternalError))
    return Fail(code, WithPrefix(absl::StrCat("server ", called_with.server), status));
  return Fail(code, status);
}

}  // namespace meshfront
