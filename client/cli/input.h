// Reads IN, from a file or standard input.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "client/cli/arguments.h"
#include "core/io/mesh_io.h"

namespace meshfront {

// `path` may be "-".
absl::StatusOr<ReadResult> ReadInput(const std::string& path, Format format);

// Whether what one file names beside itself, by a relative path, the other finds as well. "-" lies in the current folder.
bool LieInOneFolder(const std::string& a, const std::string& b);

// To standard error, one line each. Not called by a run that fails: its one sentence says why.
void PrintWarnings(const std::vector<std::string>& warnings);

}  // namespace meshfront
