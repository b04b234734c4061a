// What a server is told at its start: values only.
#pragma once

#include <cstdint>
#include <string>

#include "absl/status/status.h"
#include "absl/strings/string_view.h"
#include "absl/time/time.h"

namespace meshfront {

// What a server refuses to go beyond; GetCapabilities tells them.
struct ServerLimits {
  uint64_t max_input_bytes = 2048ull << 20;  // arrays of one input, or a file after decompression
  uint64_t max_vertices = 200'000'000;
  uint64_t max_triangles = 400'000'000;
  // Uploads of all calls together, until their jobs take them: what announcing costs nothing, sending does.
  uint64_t max_pending_bytes = 2 * max_input_bytes;
};

// What is kept of calls for further ones.
struct SessionLimits {
  int max_count = 16;               // 0: none is kept
  uint64_t max_bytes = 1ull << 30;  // of all together, about
  absl::Duration ttl = absl::Minutes(10);
};

struct ServerConfig {
  std::string listen = "127.0.0.1:50051";             // port 0: any free one
  std::string metrics_listen;                         // of the metrics; empty: none
  bool insecure = false;                              // allows an address off loopback without TLS
  int threads = 0;                                    // most of one job; 0 = all cores
  int workers = 0;                                    // jobs at a time; 0 = all cores, at least 2
  int max_queue = 256;                                // jobs that wait
  absl::Duration stall_timeout = absl::Seconds(30);   // how long a job waits for a reader, or a call for an upload
  absl::Duration keepalive = absl::Seconds(30);       // an idle connection is asked for a sign of life so often
  absl::Duration lame_duck = absl::ZeroDuration();    // from NOT_SERVING to refusing new calls
  absl::Duration drain_timeout = absl::Minutes(10);   // how long a shutdown waits for open calls before it cancels them
  absl::Duration max_job = absl::InfiniteDuration();  // the longest that a worker runs a job
  std::string log;                                    // file of the job log; empty: stderr; "off": none
  ServerLimits limits;
  SessionLimits sessions;

  int MaxThreads() const;  // `threads` with 0 resolved
  int Workers() const;     // `workers` with 0 resolved
};

// OK for HOST:PORT with a port in 0..65535, or a unix socket; else InvalidArgument naming `flag`.
absl::Status CheckListenAddress(absl::string_view flag, const std::string& address);
// Whether `address` ("host:port") can be reached from this machine only: 127.0.0.0/8, ::1, localhost, unix sockets.
bool IsLoopback(const std::string& address);

}  // namespace meshfront
