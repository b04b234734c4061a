// Early return on a status that is not OK; Debian's Abseil has no such macros.
#pragma once

#include <utility>

#include "absl/status/status.h"
#include "absl/status/statusor.h"

#define MESHFRONT_RETURN_IF_ERROR(expression)              \
  do {                                                     \
    ::absl::Status meshfront_status_ = (expression);       \
    if (!meshfront_status_.ok()) return meshfront_status_; \
  } while (false)

#define MESHFRONT_CONCAT_INNER_(a, b) a##b
#define MESHFRONT_CONCAT_(a, b) MESHFRONT_CONCAT_INNER_(a, b)
#define MESHFRONT_ASSIGN_OR_RETURN(lhs, expression) \
  MESHFRONT_ASSIGN_OR_RETURN_(MESHFRONT_CONCAT_(meshfront_or_, __LINE__), lhs, expression)
#define MESHFRONT_ASSIGN_OR_RETURN_(temporary, lhs, expression) \
  auto temporary = (expression);                                \
  if (!temporary.ok()) return temporary.status();               \
  lhs = *std::move(temporary)
