#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include "absl/status/statusor.h"
#include "server/metrics/job_observer.h"

namespace ccst::server {

/// What is so at this moment; asked for with every scrape.
struct LoadSample {
  std::int64_t queued_jobs = 0;
  std::int64_t queued_jobs_limit = 0;  ///< As many may wait.
  std::int64_t running_jobs = 0;
  std::int64_t watchers = 0;            ///< Streams that follow a job.
  std::int64_t memory_bytes = 0;        ///< Of the budget, in use.
  std::int64_t memory_limit_bytes = 0;  ///< The budget; 0: there is none.
  std::int64_t connections = 0;         ///< Open ones.
  std::int64_t connections_limit = 0;   ///< As many may be open.
  std::int64_t data_bytes = 0;          ///< Of all meshes, images and samples.
  std::int64_t data_limit_bytes = 0;    ///< What they may have; 0: what the disk has.
  std::int64_t record_bytes = 0;        ///< Of what is written down of jobs and meshes.
  std::int64_t record_limit_bytes = 0;  ///< What that may have.
  std::int64_t storage_bytes = 0;       ///< Size of the disk that the data directory is on.
  std::int64_t storage_free_bytes = 0;  ///< What the server may still write there.
};

/// Everything that is counted, and its page for Prometheus. Thread-safe.
class Metrics final : public JobObserver {
 public:
  Metrics();
  ~Metrics() override;
  Metrics(const Metrics&) = delete;
  Metrics& operator=(const Metrics&) = delete;

  /// One finished call; `code` as `OK`, `NOT_FOUND`.
  void CountRequest(std::string_view method, std::string_view code, double seconds,
                    std::int64_t bytes_in, std::int64_t bytes_out);

  /// One connection that came to nothing; `reason` as in ConnectionGate.
  void CountRefusedConnection(std::string_view reason);

  void OnPhase(std::string_view phase, double seconds) override;
  void OnAlternation() override;
  void OnEnd(std::string_view state, double seconds) override;
  void OnCancel(std::string_view reason) override;
  void OnCacheLookup(std::string_view cache, bool hit) override;

  /// Where the gauges come from; called on the scraper's thread. An empty function takes it back,
  /// and once that returned no call runs any more.
  void SetLoadReader(std::function<LoadSample()> read_load);

  /// Serves GET /metrics at `listen` (HOST:PORT, port 0 picks a free one) until destroyed.
  /// Returns HOST:PORT with the port really listened on. At most once.
  /// @errors UNAVAILABLE  the address cannot be bound
  absl::StatusOr<std::string> Serve(const std::string& listen);

 private:
  struct Families;
  struct Exporter;
  std::unique_ptr<Families> families_;
  std::unique_ptr<Exporter> exporter_;  // Last: goes first.
};

}  // namespace ccst::server
