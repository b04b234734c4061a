// What the calls of one service share.
#pragma once

#include <atomic>
#include <memory>
#include <string>

#include "server/call_gate.h"
#include "server/config.h"
#include "server/engine.h"
#include "server/job_log.h"
#include "server/metrics.h"
#include "server/pending_bytes.h"
#include "server/session_store.h"
#include "server/upload_watch.h"
#include "server/worker_pool.h"

namespace meshfront {

struct ServiceState {
  ServiceState(const ServerConfig& config, Engine engine, std::unique_ptr<JobLog> log)
      : config(config),
        engine(std::move(engine)),
        log(std::move(log)),
        pending(config.limits.max_pending_bytes),
        watch(config.stall_timeout),
        sessions(config.sessions),
        metrics([this] { return CurrentLevels(); }),
        pool(config.Workers(), config.max_queue) {}
  ~ServiceState() { metrics.StopListening(); }

  // "j-" and a number that begins anew with each server, after what tells servers apart.
  std::string NewJobId();
  Metrics::Levels CurrentLevels();

  const ServerConfig config;
  const Engine engine;
  const std::unique_ptr<JobLog> log;
  CallGate gate;
  PendingBytes pending;
  UploadWatch watch;
  SessionStore sessions;
  Metrics metrics;
  WorkerPool pool;  // last: its jobs use what is above

 private:
  std::atomic<uint64_t> jobs_{0};
};

}  // namespace meshfront
