#pragma once

#include <cstdint>
#include <string>

#include "absl/status/status.h"
#include "core/io/mesh_limits.h"
#include "proto/convert/options.h"
#include "server/app/security_options.h"
#include "server/jobs/job_runner.h"
#include "server/log/server_log.h"

namespace ccst::server {

/// Everything that can be set about a server.
struct ServerOptions {
  std::string listen = "127.0.0.1:50051";  ///< HOST:PORT; port 0 picks a free one.
  std::string metrics_listen;              ///< HOST:PORT of the metrics; empty: none.
  int threads_per_job = 1;                 ///< >= 1; does not change the samples.
  double drain_timeout_seconds = 30.0;     ///< >= 0; how long running jobs may take to finish.
  LogFormat log_format = LogFormat::kText;
  /// Ten million samples would fit the core, but not the memory of a small machine.
  RequestLimits request_limits = {.max_sample_count = 2'000'000};
  MeshLimits mesh_limits;  ///< `max_bytes` follows request_limits.max_inline_mesh_bytes.
  RunnerOptions runner;
  SecurityOptions security;

  /// INVALID_ARGUMENT OPTION_INVALID naming the first wrong option by its flag.
  absl::Status Validate() const;
};

/// As many jobs as keep running x threads within the machine's cores; at least 1.
int DefaultMaxRunningJobs(int threads_per_job);

}  // namespace ccst::server
