// What Prometheus is told: counts of what has ended, and how much there is at the moment.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include <prometheus/counter.h>
#include <prometheus/family.h>
#include <prometheus/histogram.h>
#include <prometheus/registry.h>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "meshfront/v1/events.pb.h"

namespace prometheus {
class Collectable;
class Exposer;
}  // namespace prometheus

namespace meshfront {

// Thread-safe. The names are those of the README; labels take values of fixed sets only, so that no caller makes series.
class Metrics {
 public:
  // How much there is now.
  struct Levels {
    uint64_t open_calls = 0, running_jobs = 0, queued_jobs = 0, sessions = 0, session_bytes = 0;
  };
  // `levels` is asked at each scrape.
  explicit Metrics(std::function<Levels()> levels);
  ~Metrics();

  // A call that has ended.
  struct EndedCall {
    std::string rpc;
    absl::StatusCode code = absl::StatusCode::kOk;
    double seconds = 0;
    uint64_t input_bytes = 0, triangles = 0;
  };
  void Note(const EndedCall& call);
  // Where the time of a job that was done went.
  void Note(const v1::Seconds& seconds);

  // Serves them at http://ADDRESS/metrics from now on. The address, with the port it got. Unavailable where it can't be had.
  absl::StatusOr<std::string> Listen(const std::string& address);
  // From then on `levels` is asked no more.
  void StopListening();
  // What a scrape gives, in the text format.
  std::string Text() const;

 private:
  const std::shared_ptr<prometheus::Registry> registry_;
  const std::shared_ptr<prometheus::Collectable> levels_;
  prometheus::Family<prometheus::Counter>&calls_, &received_, &triangles_;
  prometheus::Family<prometheus::Histogram>&call_seconds_, &stage_seconds_;
  std::unique_ptr<prometheus::Exposer> exposer_;
};

}  // namespace meshfront
