#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "absl/time/time.h"
#include "server/jobs/job_runner.h"
#include "server/jobs/memory_budget.h"
#include "server/jobs/run_dependencies.h"
#include "server/metrics/job_observer.h"
#include "server/store/record_bytes.h"

namespace ccst::server {

/// Bounds on jobs.
struct JobManagerOptions {
  RunnerOptions runner;
  int max_watchers_per_job = 1024;
  absl::Duration retention = absl::Hours(24);  ///< Of an ended job.
  std::int64_t memory_budget_bytes = std::int64_t{4} << 30;
  RecordLimits records;
};

/// What jobs are made of beside the store.
struct JobManagerDependencies {
  RunDependencies run;
  std::function<std::string()> new_id;
  JobObserver* observer = nullptr;  ///< Not owned.
  /// Shared with others that need memory; null: one of its own, with `memory_budget_bytes`.
  std::shared_ptr<MemoryBudget> budget = nullptr;
  /// Takes lines for whoever operates the server, on any thread; null: nobody reads them.
  std::function<void(const std::string&)> report = nullptr;
};

}  // namespace ccst::server
