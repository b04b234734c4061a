// Exceptions become statuses where a thread, a room or a program ends.
#pragma once

#include <exception>

#include "absl/status/status.h"

namespace meshfront {

// ResourceExhausted in one sentence when memory ran out (or threads did), Internal with what the exception says otherwise.
absl::Status StatusOf(const std::exception_ptr& exception);
// Of the exception that is being handled: inside a catch block only.
inline absl::Status StatusOfException() { return StatusOf(std::current_exception()); }
// Whether a status says that memory ran out, and not that a limit was passed.
bool IsOutOfMemory(const absl::Status& status);

}  // namespace meshfront
