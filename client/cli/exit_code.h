// How the program ends, for scripts.
#pragma once

#include "absl/status/status.h"

namespace meshfront {

enum class ExitCode {
  kDone = 0,
  kUsage = 2,      // the command line is wrong, or asks for what is not built yet
  kInput = 3,      // IN is missing, unreadable or can't be meshed
  kPartial = 4,    // meshed only in part; the part is written
  kServer = 5,     // the server is unreachable, unavailable, or refuses by limit or authorisation
  kCancelled = 6,  // cancelled or past the deadline
  kOutput = 7,     // OUT can't be written
  kInternalError = 70,
};

// What a failed call of the service means. InvalidArgument with a BadRequest about the options is the caller's (2), otherwise
// the input's (3). DataLoss is the connection's (5): the same call may succeed.
ExitCode ExitCodeOfCall(const absl::Status& status);

// What a file that can't be read means: the input's fault (3), unless memory ran out.
ExitCode ExitCodeOfRead(const absl::Status& status);

// Writes "meshfront: <message>" to standard error, with what the details of the error add, and returns the code.
ExitCode Fail(ExitCode code, const absl::Status& status);

}  // namespace meshfront
