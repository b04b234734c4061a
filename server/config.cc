#include "server/config.h"

#include <algorithm>
#include <thread>

#include "absl/strings/match.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_split.h"
#include "proto/wire/host_port.h"

namespace meshfront {
namespace {

int Cores() { return static_cast<int>(std::max(1u, std::thread::hardware_concurrency())); }

bool IsUnixSocket(absl::string_view address) {
  return absl::StartsWith(address, "unix:") || absl::StartsWith(address, "unix-abstract:");
}

// Four decimal numbers below 256, the first of them 127: a name such as 127.example.org is not.
bool IsLoopbackV4(absl::string_view host) {
  const std::vector<absl::string_view> parts = absl::StrSplit(host, '.');
  if (parts.size() != 4 || parts[0] != "127") return false;
  return std::all_of(parts.begin(), parts.end(), [](absl::string_view part) {
    uint32_t value = 0;
    return absl::SimpleAtoi(part, &value) && value < 256;
  });
}

}  // namespace

int ServerConfig::MaxThreads() const { return threads > 0 ? threads : Cores(); }
int ServerConfig::Workers() const { return workers > 0 ? workers : std::max(2, Cores()); }

absl::Status CheckListenAddress(absl::string_view flag, const std::string& address) {
  return IsUnixSocket(address) ? absl::OkStatus() : CheckHostPort(flag, address, 0);
}

bool IsLoopback(const std::string& address) {
  if (IsUnixSocket(address)) return true;
  const size_t colon = address.rfind(':');
  absl::string_view host = absl::string_view(address).substr(0, colon);
  if (absl::StartsWith(host, "[") && absl::EndsWith(host, "]")) host = host.substr(1, host.size() - 2);
  return host == "localhost" || host == "::1" || IsLoopbackV4(host);
}

}  // namespace meshfront
