#include "proto/wire/host_port.h"

#include <algorithm>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"

namespace meshfront {
namespace {

constexpr int kLargestPort = 65535;
constexpr size_t kMostPortDigits = 5;

template <class Test>
bool IsMadeOf(absl::string_view text, Test test) {
  return !text.empty() &&
         std::all_of(text.begin(), text.end(), [&](char c) { return test(static_cast<unsigned char>(c)); });
}

bool IsHost(absl::string_view host) {
  if (absl::StartsWith(host, "[")) {
    // Hexadecimal groups, perhaps an IPv4 tail, perhaps a zone.
    return absl::EndsWith(host, "]") && IsMadeOf(host.substr(1, host.size() - 2), [](unsigned char c) {
             return absl::ascii_isalnum(c) || c == ':' || c == '.' || c == '%';
           });
  }
  return IsMadeOf(host, [](unsigned char c) { return absl::ascii_isalnum(c) || c == '.' || c == '-' || c == '_'; });
}

bool IsPort(absl::string_view text, int least) {
  int port = 0;
  return IsMadeOf(text, absl::ascii_isdigit) && text.size() <= kMostPortDigits && absl::SimpleAtoi(text, &port) &&
         port >= least && port <= kLargestPort;
}

}  // namespace

absl::Status CheckHostPort(absl::string_view flag, absl::string_view address, int least_port) {
  const size_t colon = address.rfind(':');
  if (colon != absl::string_view::npos && IsHost(address.substr(0, colon)) &&
      IsPort(address.substr(colon + 1), least_port)) {
    return absl::OkStatus();
  }
  return absl::InvalidArgumentError(absl::StrCat(flag, " is ", address.empty() ? "empty" : address,
                                                 "; it must be HOST:PORT with a port from ", least_port, " to ",
                                                 kLargestPort));
}

}  // namespace meshfront
