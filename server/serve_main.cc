#include "server/serve_main.h"

#include <pthread.h>
#include <signal.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <system_error>
#include <thread>

#include "core/base/exceptions.h"
#include "core/base/status_macros.h"
#include "server/config.h"
#include "server/server.h"
#include "server/version.h"

namespace meshfront {
namespace {

enum ExitCode { kDone = 0, kKilled = 1, kUsage = 2, kUnavailable = 5, kInternal = 70 };

struct Flags {
  ServerConfig config;
  double stall_timeout = 30;
  double keepalive = 30;
  double lame_duck = 0;
  double drain_timeout = 600;
  double max_job_seconds = 0;
  uint64_t max_input_mb = 2048, max_session_mb = 1024;
  double session_ttl = 600;
  bool print_config = false;

  void Resolve() {
    config.stall_timeout = absl::Seconds(stall_timeout);
    config.keepalive = absl::Seconds(keepalive);
    config.lame_duck = absl::Seconds(lame_duck);
    config.drain_timeout = absl::Seconds(drain_timeout);
    if (max_job_seconds > 0) config.max_job = absl::Seconds(max_job_seconds);
    config.sessions.max_bytes = max_session_mb << 20;
    config.sessions.ttl = absl::Seconds(session_ttl);
    config.limits.max_input_bytes = max_input_mb << 20;
    config.limits.max_pending_bytes = 2 * config.limits.max_input_bytes;
  }
};

// Every flag has an environment twin: MESHFRONT_ and its name in capitals.
void AddFlags(CLI::App& app, Flags& flags) {
  ServerConfig& config = flags.config;
  app.add_option("--listen", config.listen, "Address to listen on; port 0: any free one")
      ->envname("MESHFRONT_LISTEN")
      ->capture_default_str();
  app.add_option("--metrics-listen", flags.config.metrics_listen,
                 "Address of the metrics, for Prometheus; port 0: any free one; empty: none")
      ->envname("MESHFRONT_METRICS_LISTEN");
  app.add_option("--threads", config.threads, "Most threads of one job; 0: all cores")
      ->envname("MESHFRONT_THREADS")
      ->check(CLI::Range(0, 1024))
      ->capture_default_str();
  app.add_option("--workers", config.workers, "Jobs that run at a time; 0: all cores, at least 2")
      ->envname("MESHFRONT_WORKERS")
      ->check(CLI::Range(0, 1024))
      ->capture_default_str();
  app.add_option("--max-queue", config.max_queue, "Jobs that may wait for a worker")
      ->envname("MESHFRONT_MAX_QUEUE")
      ->check(CLI::Range(0, 1'000'000))
      ->capture_default_str();
  app.add_option("--max-input-mb", flags.max_input_mb, "Largest input, in MiB")
      ->envname("MESHFRONT_MAX_INPUT_MB")
      ->check(CLI::Range(1, 1 << 20))
      ->capture_default_str();
  app.add_option("--stall-timeout", flags.stall_timeout, "Seconds that a reader or an upload may stand still")
      ->envname("MESHFRONT_STALL_TIMEOUT")
      ->check(CLI::Range(0.001, 86400.0))
      ->capture_default_str();
  app.add_option("--keepalive", flags.keepalive, "Seconds between signs of life asked of an idle connection")
      ->envname("MESHFRONT_KEEPALIVE")
      ->check(CLI::Range(1.0, 86400.0))
      ->capture_default_str();
  app.add_option("--lame-duck", flags.lame_duck, "Seconds from NOT_SERVING to refusing new calls at shutdown")
      ->envname("MESHFRONT_LAME_DUCK")
      ->check(CLI::Range(0.0, 3600.0))
      ->capture_default_str();
  app.add_option("--drain-timeout", flags.drain_timeout,
                 "Seconds that a shutdown waits for open calls before it cuts them off")
      ->envname("MESHFRONT_DRAIN_TIMEOUT")
      ->check(CLI::Range(0.001, 86400.0))
      ->capture_default_str();
  app.add_option("--max-job-seconds", flags.max_job_seconds, "Longest that one job may run, in seconds; 0: no limit")
      ->envname("MESHFRONT_MAX_JOB_SECONDS")
      ->check(CLI::Range(0.0, 1e9))
      ->capture_default_str();
  app.add_option("--max-sessions", config.sessions.max_count, "Meshes that are kept between calls; 0: none")
      ->envname("MESHFRONT_MAX_SESSIONS")
      ->check(CLI::Range(0, 1'000'000))
      ->capture_default_str();
  app.add_option("--max-session-mb", flags.max_session_mb, "Memory of all meshes that are kept, in MiB")
      ->envname("MESHFRONT_MAX_SESSION_MB")
      ->check(CLI::Range(1, 1 << 20))
      ->capture_default_str();
  app.add_option("--session-ttl", flags.session_ttl, "Seconds that a mesh is kept after it was used last")
      ->envname("MESHFRONT_SESSION_TTL")
      ->check(CLI::Range(0.001, 1e9))
      ->capture_default_str();
  app.add_option("--log", config.log, "File of the job log; empty: stderr; off: none")->envname("MESHFRONT_LOG");
  app.add_flag("--insecure", config.insecure, "Allow an address off loopback without TLS")
      ->envname("MESHFRONT_INSECURE");
  app.add_flag("--print-config", flags.print_config, "Print the values in force as JSON and stop")
      ->envname("MESHFRONT_PRINT_CONFIG");
  app.set_version_flag("--version", std::string("meshfrontd ") + kVersion);
}

void PrintConfig(const Flags& flags) {
  const ServerConfig& c = flags.config;
  const nlohmann::ordered_json json = {{"listen", c.listen},
                                       {"metrics_listen", flags.config.metrics_listen},
                                       {"insecure", c.insecure},
                                       {"threads", c.MaxThreads()},
                                       {"workers", c.Workers()},
                                       {"max_queue", c.max_queue},
                                       {"max_input_mb", flags.max_input_mb},
                                       {"stall_timeout", flags.stall_timeout},
                                       {"keepalive", flags.keepalive},
                                       {"lame_duck", flags.lame_duck},
                                       {"drain_timeout", flags.drain_timeout},
                                       {"max_job_seconds", flags.max_job_seconds},
                                       {"max_sessions", c.sessions.max_count},
                                       {"max_session_mb", flags.max_session_mb},
                                       {"session_ttl", flags.session_ttl},
                                       {"log", c.log}};
  std::cout << json.dump(2) << "\n";
}

sigset_t ShutdownSignals() {
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGTERM);
  sigaddset(&signals, SIGINT);
  return signals;
}

// Waits for the first signal; from then on a thread waits for the second, which ends the process.
void WaitForSignal(const sigset_t& signals) {
  int signal = 0;
  sigwait(&signals, &signal);
  try {
    std::thread([signals] {
      int second = 0;
      sigwait(&signals, &second);
      std::fputs("meshfrontd ended by a second signal\n", stderr);
      _exit(kKilled);
    }).detach();
  } catch (const std::system_error&) {
    // No room for one more thread: then a second signal waits for the first.
  }
}

int ExitCodeOf(const absl::Status& status) {
  switch (status.code()) {
    case absl::StatusCode::kInvalidArgument:
      return kUsage;
    case absl::StatusCode::kUnavailable:
      return kUnavailable;
    case absl::StatusCode::kInternal:
      return kInternal;
    default:
      return kUsage;
  }
}

int Serve(const ServerConfig& config) {
  // Blocked before gRPC starts its threads, which inherit it: the signals come to sigwait alone.
  const sigset_t signals = ShutdownSignals();
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  signal(SIGPIPE, SIG_IGN);
  absl::StatusOr<std::unique_ptr<Server>> server = Server::Start(config);
  if (!server.ok()) {
    std::fprintf(stderr, "meshfrontd: %s\n", std::string(server.status().message()).c_str());
    return ExitCodeOf(server.status());
  }
  std::fprintf(stderr, "meshfrontd listening on %s\n", (*server)->address().c_str());
  if (!config.metrics_listen.empty())
    std::fprintf(stderr, "meshfrontd metrics on http://%s/metrics\n", (*server)->metrics_address().c_str());
  WaitForSignal(signals);
  const absl::Status drained = (*server)->DrainAndShutdown();
  if (drained.ok()) return kDone;
  std::fprintf(stderr, "meshfrontd: %s\n", std::string(drained.message()).c_str());
  _exit(kKilled);  // what hangs would hang the destructors too
}

absl::Status CheckAddresses(const Flags& flags) {
  MESHFRONT_RETURN_IF_ERROR(CheckListenAddress("--listen", flags.config.listen));
  return flags.config.metrics_listen.empty() ? absl::OkStatus()
                                             : CheckListenAddress("--metrics-listen", flags.config.metrics_listen);
}

int ParseAndServe(int argc, char** argv) {
  Flags flags;
  CLI::App app("The Meshfront server: remeshes over gRPC until it gets SIGTERM.", "meshfrontd");
  AddFlags(app, flags);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? kDone : kUsage;
  }
  flags.Resolve();
  if (const absl::Status checked = CheckAddresses(flags); !checked.ok()) {
    std::fprintf(stderr, "meshfrontd: %s\n", std::string(checked.message()).c_str());
    return kUsage;
  }
  if (flags.print_config) {
    PrintConfig(flags);
    return kDone;
  }
  return Serve(flags.config);
}

}  // namespace

int ServeMain(int argc, char** argv) {
  try {
    return ParseAndServe(argc, argv);
  } catch (...) {
    std::fprintf(stderr, "meshfrontd: %s\n", std::string(StatusOfException().message()).c_str());
    return kInternal;
  }
}

}  // namespace meshfront
