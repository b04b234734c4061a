// How a command ends when its call of the service fails.
#pragma once

#include <string>

#include "absl/status/status.h"
#include "client/cli/exit_code.h"

namespace meshfront {

// What the user typed, for the sentence.
struct CalledWith {
  std::string in;      // "-": standard input
  std::string server;  // empty: in process
  double timeout;      // seconds, infinite without --timeout
};

// Says in one sentence what failed, and who or what it was about: IN, the server, the time that was allowed. Returns the code.
ExitCode FailCall(const absl::Status& status, const CalledWith& called_with);

}  // namespace meshfront
