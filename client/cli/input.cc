#include "client/cli/input.h"

#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <iostream>

#include "absl/strings/str_cat.h"
#include "client/output_file.h"
#include "core/base/status_macros.h"

namespace meshfront {
namespace {

absl::StatusOr<std::vector<uint8_t>> ReadAll(int descriptor, const std::string& name) {
  constexpr size_t step = 1 << 20;
  const uint64_t most = ReadLimits().max_decompressed_bytes;
  std::vector<uint8_t> bytes;
  size_t used = 0;
  for (;;) {
    if (bytes.size() - used < step) bytes.resize(std::max(2 * bytes.size(), step));
    const ssize_t got = read(descriptor, bytes.data() + used, bytes.size() - used);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return absl::UnavailableError(absl::StrCat(name, " can't be read: ", strerror(errno)));
    if (got == 0) break;
    used += got;
    if (used > most) return absl::InvalidArgumentError(absl::StrCat(name, " is larger than ", most, " bytes"));
  }
  bytes.resize(used);
  return bytes;
}

absl::StatusOr<ReadResult> Read(const std::string& path, Format format) {
  const std::string standard_input = "standard input";
  if (path == "-") {
    MESHFRONT_ASSIGN_OR_RETURN(const std::vector<uint8_t> bytes, ReadAll(STDIN_FILENO, standard_input));
    return ReadMesh(bytes, format, standard_input);
  }
  return ReadMeshFile(path);
}

}  // namespace

absl::StatusOr<ReadResult> ReadInput(const std::string& path, Format format) { return Read(path, format); }

bool LieInOneFolder(const std::string& a, const std::string& b) {
  const auto folder = [](const std::string& path) {
    std::error_code ignored;
    const std::filesystem::path file = path == "-" ? std::filesystem::path(".") / "-" : std::filesystem::path(path);
    const std::filesystem::path whole = std::filesystem::absolute(file, ignored).parent_path();
    const std::filesystem::path found = std::filesystem::weakly_canonical(whole, ignored);
    return found.empty() ? whole : found;
  };
  return folder(a) == folder(b);
}

void PrintWarnings(const std::vector<std::string>& warnings) {
  for (const std::string& warning : warnings) std::cerr << "meshfront: warning: " << warning << "\n";
}

}  // namespace meshfront
