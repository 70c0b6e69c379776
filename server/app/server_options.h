#pragma once

#include <cstdint>
#include <string>

#include "absl/status/status.h"
#include "core/io/mesh_limits.h"
#include "proto/convert/options.h"
#include "server/app/security_options.h"
#include "server/jobs/job_manager.h"
#include "server/log/server_log.h"
#include "server/meshes/mesh_store.h"
#include "server/net/gate.h"
#include "server/rpc/stream_memory.h"

namespace ccst::server {

/// Most jobs that may run at once.
inline constexpr int kMaxRunningJobs = 1024;

/// Everything that can be set about a server.
struct ServerOptions {
  std::string listen = "127.0.0.1:50051";  ///< HOST:PORT; port 0 picks a free one.
  /// Path of a Unix socket for a proxy in front; empty: none.
  std::string proxy_socket;
  int max_connections = 2048;             ///< >= 1; fewer where there are too few descriptors.
  int max_connections_per_address = 256;  ///< >= 1
  /// Where jobs, meshes and results are kept; empty: a directory of the user's.
  std::string data_dir;
  std::string metrics_listen;           ///< HOST:PORT of the metrics; empty: none.
  int threads_per_job = 1;              ///< >= 1; does not change the samples.
  double drain_timeout_seconds = 30.0;  ///< >= 0; how long running jobs may take to finish.
  LogFormat log_format = LogFormat::kText;
  /// Ten million samples would fit the core, but not the memory of a small machine.
  RequestLimits request_limits = {.max_sample_count = 2'000'000};
  MeshLimits mesh_limits = {.max_bytes = std::int64_t{256} << 20};
  std::int64_t max_data_bytes = 0;  ///< Of all meshes, images and samples; 0: what the disk has.
  std::int64_t max_stored_mesh_bytes = std::int64_t{4} << 30;  ///< Of one caller.
  RecordLimits records;                         ///< What is written down of jobs and meshes.
  double mesh_retention_seconds = 7 * 86400.0;  ///< Of an unused mesh.
  RunnerOptions runner;
  std::int64_t max_job_memory_bytes = 0;  ///< Of all that run, by estimate; 0: half the machine's.
  int max_watchers_per_job = 1024;
  StreamLimits streams;
  double job_retention_seconds = 86400.0;  ///< Of an ended job.
  SecurityOptions security;

  /// INVALID_ARGUMENT OPTION_INVALID naming the first wrong option by its flag.
  absl::Status Validate() const;

  // The parts, as those who need them want them.
  MeshStoreOptions MeshOptions() const;
  JobManagerOptions JobOptions() const;
  /// @param descriptors  as many as the process may have open; half of few, or all but a thousand,
  ///                     are for connections.
  GateOptions ConnectionOptions(std::int64_t descriptors) const;
  /// `max_data_bytes`, or the largest number where only the disk says.
  std::int64_t MaxDataBytes() const;
};

/// As many jobs as keep running x threads within the machine's cores; at least 1.
int DefaultMaxRunningJobs(int threads_per_job);

}  // namespace ccst::server
