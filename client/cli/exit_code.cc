#include "client/cli/exit_code.h"

#include <iostream>
#include <string>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "proto/wire/errors.h"

namespace meshfront {
namespace {

constexpr char kOptionsPath[] = "options";

// The message begins with the path of the option at fault: "options.eta is 3; …".
bool IsAboutOptions(const absl::Status& status) {
  return absl::StartsWith(FieldPathOf(status.message()), kOptionsPath);
}

}  // namespace

ExitCode ExitCodeOfCall(const absl::Status& status) {
  if (ReasonOf(status).reason == "SESSION_CHANGED") return ExitCode::kInput;  // the mesh that is meant is gone
  switch (status.code()) {
    case absl::StatusCode::kOk:
      return ExitCode::kDone;
    case absl::StatusCode::kInvalidArgument:
      return IsAboutOptions(status) ? ExitCode::kUsage : ExitCode::kInput;
    case absl::StatusCode::kFailedPrecondition:
    case absl::StatusCode::kNotFound:  // a session that is gone: the input is missing
      return ExitCode::kInput;
    case absl::StatusCode::kUnavailable:
    case absl::StatusCode::kResourceExhausted:
    case absl::StatusCode::kUnauthenticated:
    case absl::StatusCode::kPermissionDenied:
    case absl::StatusCode::kUnimplemented:  // an older server, or no server of ours
    case absl::StatusCode::kAborted:
    case absl::StatusCode::kDataLoss:
      return ExitCode::kServer;
    case absl::StatusCode::kCancelled:
    case absl::StatusCode::kDeadlineExceeded:
      return ExitCode::kCancelled;
    default:
      return ExitCode::kInternalError;
  }
}

ExitCode ExitCodeOfRead(const absl::Status& status) {
  return absl::IsResourceExhausted(status) ? ExitCode::kInternalError : ExitCode::kInput;
}

ExitCode Fail(ExitCode code, const absl::Status& status) {
  std::cerr << absl::StrCat("meshfront: ", status.message(), "\n");
  return code;
}

}  // namespace meshfront
