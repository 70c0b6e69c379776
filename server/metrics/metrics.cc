#include "server/metrics/metrics.h"

#include <mutex>
#include <utility>
#include <vector>

#include <prometheus/collectable.h>
#include <prometheus/counter.h>
#include <prometheus/exposer.h>
#include <prometheus/histogram.h>
#include <prometheus/registry.h>

#include "absl/status/status.h"
#include "server/base/lost_log_lines.h"

namespace ccst::server {
namespace {

// From what a cached answer takes to the longest job [s].
const prometheus::Histogram::BucketBoundaries kSecondsBuckets = {
    0.001, 0.005, 0.01, 0.025, 0.05, 0.1, 0.25, 0.5, 1, 2.5, 5, 10, 30, 60, 300, 1800};

prometheus::Family<prometheus::Counter>& Counters(prometheus::Registry& registry, const char* name,
                                                  const char* help) {
  return prometheus::BuildCounter().Name(name).Help(help).Register(registry);
}

prometheus::Family<prometheus::Histogram>& Histograms(prometheus::Registry& registry,
                                                      const char* name, const char* help) {
  return prometheus::BuildHistogram().Name(name).Help(help).Register(registry);
}

prometheus::MetricFamily Gauge(const char* name, const char* help, std::int64_t value) {
  prometheus::ClientMetric metric;
  metric.gauge.value = static_cast<double>(value);
  return {.name = name, .help = help, .type = prometheus::MetricType::Gauge, .metric = {metric}};
}

prometheus::MetricFamily Counter(const char* name, const char* help, std::int64_t value) {
  prometheus::ClientMetric metric;
  metric.counter.value = static_cast<double>(value);
  return {.name = name, .help = help, .type = prometheus::MetricType::Counter, .metric = {metric}};
}

// Figures that are read when they are asked for.
class Load final : public prometheus::Collectable {
 public:
  void SetReader(std::function<LoadSample()> read) {
    const std::lock_guard lock(mutex_);
    read_ = std::move(read);
  }

  std::vector<prometheus::MetricFamily> Collect() const override {
    const std::lock_guard lock(mutex_);
    if (!read_) return {};
    const LoadSample load = read_();
    return {
        Gauge("ccst_jobs_queued", "Jobs that wait.", load.queued_jobs),
        Gauge("ccst_jobs_queued_limit", "Jobs that may wait.", load.queued_jobs_limit),
        Gauge("ccst_jobs_running", "Jobs that compute.", load.running_jobs),
        Gauge("ccst_watchers", "Streams that follow a job.", load.watchers),
        Gauge("ccst_memory_bytes", "Memory of the budget in use.", load.memory_bytes),
        Gauge("ccst_memory_limit_bytes", "The memory budget.", load.memory_limit_bytes),
        Gauge("ccst_connections", "Open connections.", load.connections),
        Gauge("ccst_connections_limit", "Connections that may be open.", load.connections_limit),
        Gauge("ccst_data_bytes", "Bytes of all meshes, images and samples.", load.data_bytes),
        Gauge("ccst_data_limit_bytes", "What they may have.", load.data_limit_bytes),
        Gauge("ccst_record_bytes", "Bytes of records.", load.record_bytes),
        Gauge("ccst_record_limit_bytes", "What they may have.", load.record_limit_bytes),
        Gauge("ccst_storage_bytes", "Size of the data directory's disk.", load.storage_bytes),
        Gauge("ccst_storage_free_bytes", "What is free there.", load.storage_free_bytes),
        Counter("ccst_log_lines_lost_total", "Lines of the log that nobody read.", lost_log_lines)};
  }

 private:
  mutable std::mutex mutex_;
  std::function<LoadSample()> read_;
};

// Who sends half a request holds a thread, for no longer than a scrape takes.
std::vector<std::string> ServingOptions(const std::string& listen) {
  return {"listening_ports",    listen, "num_threads",      "8",
          "request_timeout_ms", "1000", "connection_queue", "64"};
}

}  // namespace

struct Metrics::Families {
  std::shared_ptr<prometheus::Registry> registry = std::make_shared<prometheus::Registry>();
  std::shared_ptr<Load> load = std::make_shared<Load>();
  prometheus::Family<prometheus::Counter>& requests =
      Counters(*registry, "ccst_requests_total", "Finished calls by method and code.");
  prometheus::Family<prometheus::Histogram>& request_seconds = Histograms(
      *registry, "ccst_request_seconds", "Time from a call's arrival to its end, by method.");
  prometheus::Family<prometheus::Counter>& bytes_in =
      Counters(*registry, "ccst_request_bytes_total", "Bytes of messages received, by method.");
  prometheus::Family<prometheus::Counter>& bytes_out =
      Counters(*registry, "ccst_response_bytes_total", "Bytes of messages sent, by method.");
  prometheus::Family<prometheus::Counter>& refused_connections =
      Counters(*registry, "ccst_connections_refused_total",
               "Connections that were refused or ended for what they did, by reason.");
  prometheus::Family<prometheus::Histogram>& phase_seconds =
      Histograms(*registry, "ccst_phase_seconds", "Time a job spent in a phase.");
  prometheus::Counter& alternations =
      Counters(*registry, "ccst_alternations_total", "Alternations of all jobs.").Add({});
  prometheus::Family<prometheus::Histogram>& job_seconds = Histograms(
      *registry, "ccst_job_seconds", "Time from a job's submission to its end, by state.");
  prometheus::Family<prometheus::Counter>& cancels =
      Counters(*registry, "ccst_job_cancels_total", "Jobs asked to stop, by who or what asked.");
  prometheus::Family<prometheus::Counter>& cache_lookups =
      Counters(*registry, "ccst_cache_lookups_total", "Lookups by digest, by cache and result.");
};

struct Metrics::Exporter {
  prometheus::Exposer exposer;
};

Metrics::Metrics() : families_(std::make_unique<Families>()) {}

Metrics::~Metrics() = default;

void Metrics::CountRequest(std::string_view method, std::string_view code, double seconds,
                           std::int64_t bytes_in, std::int64_t bytes_out) {
  const std::string name(method);
  families_->requests.Add({{"method", name}, {"code", std::string(code)}}).Increment();
  families_->request_seconds.Add({{"method", name}}, kSecondsBuckets).Observe(seconds);
  families_->bytes_in.Add({{"method", name}}).Increment(static_cast<double>(bytes_in));
  families_->bytes_out.Add({{"method", name}}).Increment(static_cast<double>(bytes_out));
}

void Metrics::CountRefusedConnection(std::string_view reason) {
  families_->refused_connections.Add({{"reason", std::string(reason)}}).Increment();
}

void Metrics::OnPhase(std::string_view phase, double seconds) {
  families_->phase_seconds.Add({{"phase", std::string(phase)}}, kSecondsBuckets).Observe(seconds);
}

void Metrics::OnAlternation() { families_->alternations.Increment(); }

void Metrics::OnEnd(std::string_view state, double seconds) {
  families_->job_seconds.Add({{"state", std::string(state)}}, kSecondsBuckets).Observe(seconds);
}

void Metrics::OnCancel(std::string_view reason) {
  families_->cancels.Add({{"reason", std::string(reason)}}).Increment();
}

void Metrics::OnCacheLookup(std::string_view cache, bool hit) {
  families_->cache_lookups.Add({{"cache", std::string(cache)}, {"result", hit ? "hit" : "miss"}})
      .Increment();
}

void Metrics::SetLoadReader(std::function<LoadSample()> read_load) {
  families_->load->SetReader(std::move(read_load));
}

absl::StatusOr<std::string> Metrics::Serve(const std::string& listen) {
  try {
    exporter_.reset(new Exporter{.exposer = prometheus::Exposer(ServingOptions(listen))});
  } catch (const std::exception&) {
    return absl::UnavailableError("cannot listen on " + listen +
                                  " for metrics; the address may be in use or not of this machine");
  }
  exporter_->exposer.RegisterCollectable(families_->registry);
  exporter_->exposer.RegisterCollectable(families_->load);
  const int port = exporter_->exposer.GetListeningPorts().at(0);
  return listen.substr(0, listen.rfind(':') + 1) + std::to_string(port);
}

}  // namespace ccst::server
