// Reads IN, from a file or standard input.
#pragma once

#include <string>

#include "absl/status/statusor.h"
#include "client/cli/arguments.h"
#include "core/io/mesh_io.h"

namespace meshfront {

// `path` may be "-". Warnings of the reader go to standard error, one line each.
absl::StatusOr<ReadResult> ReadInput(const std::string& path, Format format);

}  // namespace meshfront
