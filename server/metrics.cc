#include "server/metrics.h"

#include <prometheus/collectable.h>
#include <prometheus/exposer.h>
#include <prometheus/text_serializer.h>
#include <unistd.h>

#include <exception>
#include <fstream>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "server/version.h"

namespace meshfront {
namespace {

// From a small mesh to the largest that a server takes, in seconds.
const prometheus::Histogram::BucketBoundaries& Buckets() {
  static const prometheus::Histogram::BucketBoundaries buckets = {0.001, 0.003, 0.01, 0.03, 0.1, 0.3,
                                                                  1,     3,     10,   30,   100, 300};
  return buckets;
}

// Of this process, in bytes; 0 where the system does not tell.
double ResidentBytes() {
  std::ifstream statm("/proc/self/statm");
  uint64_t size = 0, resident = 0;
  statm >> size >> resident;
  return static_cast<double>(resident) * static_cast<double>(sysconf(_SC_PAGESIZE));
}

class LevelsCollector : public prometheus::Collectable {
 public:
  explicit LevelsCollector(std::function<Metrics::Levels()> levels) : levels_(std::move(levels)) {}

  std::vector<prometheus::MetricFamily> Collect() const override {
    const Metrics::Levels now = levels_();
    return {Gauge("meshfront_open_calls", "Calls that are open", static_cast<double>(now.open_calls)),
            Gauge("meshfront_running_jobs", "Jobs that a worker has", static_cast<double>(now.running_jobs)),
            Gauge("meshfront_queued_jobs", "Jobs that wait for a worker", static_cast<double>(now.queued_jobs)),
            Gauge("meshfront_sessions", "Meshes kept between calls", static_cast<double>(now.sessions)),
            Gauge("meshfront_session_bytes", "Memory of those, about", static_cast<double>(now.session_bytes)),
            Gauge("process_resident_memory_bytes", "Resident memory of the server", ResidentBytes()),
            Gauge("meshfront_build_info", "1; the label says the version", 1, {"version", kVersion})};
  }

 private:
  static prometheus::MetricFamily Gauge(std::string name, std::string help, double value,
                                        prometheus::ClientMetric::Label label = {}) {
    prometheus::ClientMetric metric;
    metric.gauge.value = value;
    if (!label.name.empty()) metric.label.push_back(std::move(label));
    return {std::move(name), std::move(help), prometheus::MetricType::Gauge, {std::move(metric)}};
  }

  const std::function<Metrics::Levels()> levels_;
};

prometheus::Family<prometheus::Counter>& AddCounter(prometheus::Registry& registry, const char* name,
                                                    const char* help) {
  return prometheus::BuildCounter().Name(name).Help(help).Register(registry);
}
prometheus::Family<prometheus::Histogram>& AddHistogram(prometheus::Registry& registry, const char* name,
                                                        const char* help) {
  return prometheus::BuildHistogram().Name(name).Help(help).Register(registry);
}

}  // namespace

Metrics::Metrics(std::function<Levels()> levels)
    : registry_(std::make_shared<prometheus::Registry>()),
      levels_(std::make_shared<LevelsCollector>(std::move(levels))),
      calls_(AddCounter(*registry_, "meshfront_calls_total", "Calls that have ended, by their code")),
      received_(AddCounter(*registry_, "meshfront_received_bytes_total", "Bytes of the inputs of those calls")),
      triangles_(AddCounter(*registry_, "meshfront_triangles_total", "Triangles that they were sent")),
      call_seconds_(AddHistogram(*registry_, "meshfront_call_seconds", "From the first byte to the end of a call")),
      stage_seconds_(AddHistogram(*registry_, "meshfront_stage_seconds", "Stages of the jobs that were done")) {}

Metrics::~Metrics() = default;

void Metrics::Note(const EndedCall& call) {
  calls_.Add({{"rpc", call.rpc}, {"code", absl::StatusCodeToString(call.code)}}).Increment();
  received_.Add({{"rpc", call.rpc}}).Increment(static_cast<double>(call.input_bytes));
  triangles_.Add({{"rpc", call.rpc}}).Increment(static_cast<double>(call.triangles));
  call_seconds_.Add({{"rpc", call.rpc}}, Buckets()).Observe(call.seconds);
}

void Metrics::Note(const v1::Seconds& s) {
  for (const auto& [stage, seconds] : {std::pair{"upload", s.upload()},
                                       {"queued", s.queued()},
                                       {"repair", s.repair()},
                                       {"index", s.index()},
                                       {"curvature", s.curvature()},
                                       {"guidance", s.guidance()},
                                       {"features", s.features()},
                                       {"mesh", s.mesh()},
                                       {"stalled", s.stalled()},
                                       {"engine", s.engine()}})
    stage_seconds_.Add({{"stage", stage}}, Buckets()).Observe(seconds);
}

absl::StatusOr<std::string> Metrics::Listen(const std::string& address) {
  try {
    // A connection that says nothing costs one of the threads for that long.
    exposer_ = std::make_unique<prometheus::Exposer>(
        std::vector<std::string>{"listening_ports", address, "num_threads", "4", "request_timeout_ms", "2000"});
    exposer_->RegisterCollectable(registry_);
    exposer_->RegisterCollectable(levels_);
    const std::vector<int> ports = exposer_->GetListeningPorts();
    const std::string host = address.substr(0, address.rfind(':'));
    return ports.empty() ? address : absl::StrCat(host, ":", ports.front());
  } catch (const std::exception&) {
    return absl::UnavailableError(
        absl::StrCat("can't listen on ", address, " for the metrics; is the port taken, or the address none of IPv4?"));
  }
}

void Metrics::StopListening() { exposer_.reset(); }

std::string Metrics::Text() const {
  std::vector<prometheus::MetricFamily> families = registry_->Collect();
  for (prometheus::MetricFamily& family : levels_->Collect()) families.push_back(std::move(family));
  return prometheus::TextSerializer().Serialize(families);
}

}  // namespace meshfront
