// Addresses on the network as both ends spell them: HOST:PORT.
#pragma once

#include "absl/status/status.h"
#include "absl/strings/string_view.h"

namespace meshfront {

// OK for a name, an IPv4 address or an IPv6 address in brackets, a colon, and a decimal port in [least_port, 65535]. Otherwise
// InvalidArgument: "--listen is foo; it must be HOST:PORT with a port from 0 to 65535". Looks nothing up.
absl::Status CheckHostPort(absl::string_view flag, absl::string_view address, int least_port);

}  // namespace meshfront
