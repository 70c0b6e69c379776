#include "server/app/server_options.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <string>
#include <thread>
#include <utility>

#include <unistd.h>

#include "core/base/status.h"
#include "server/app/listen_address.h"

namespace ccst::server {
namespace {

// gRPC counts message sizes in 32 bits; a mebibyte is left for the rest of the request.
constexpr std::int64_t kLargestTexture = std::int64_t{256} << 20;
constexpr std::int64_t kLargestInlineMesh =
    std::numeric_limits<std::int32_t>::max() - kLargestTexture - (2 << 20);
constexpr std::int64_t kLargestCount = std::numeric_limits<std::int32_t>::max();
constexpr std::int64_t kLargestMesh = std::numeric_limits<std::int32_t>::max();
constexpr std::int64_t kLargestBytes = std::numeric_limits<std::int64_t>::max();
constexpr double kLongestSeconds = 1e9;
// The kernel's, with the zero byte at the end.
constexpr std::size_t kLongestSocketPath = 108;
// For files, and for what other parts connect to.
constexpr std::int64_t kOtherDescriptors = 1024;

// Memory of the machine, or of the control group where that has a limit.
std::int64_t MachineMemory() {
  const std::int64_t machine = std::int64_t{sysconf(_SC_PHYS_PAGES)} * sysconf(_SC_PAGESIZE);
  std::int64_t limit = machine;
  for (const char* file :
       {"/sys/fs/cgroup/memory.max", "/sys/fs/cgroup/memory/memory.limit_in_bytes"}) {
    std::ifstream in(file);
    std::int64_t bytes = 0;
    if (in >> bytes && bytes > 0) limit = std::min(limit, bytes);
  }
  return limit;
}

absl::Status Check(bool right, const std::string& flag, const std::string& range) {
  if (right) return absl::OkStatus();
  return MakeError(absl::StatusCode::kInvalidArgument, ErrorReason::kOptionInvalid,
                   flag + " must be " + range);
}

absl::Status CheckRange(std::int64_t value, std::int64_t low, std::int64_t high,
                        const std::string& flag) {
  return Check(value >= low && value <= high, flag,
               "in [" + std::to_string(low) + ", " + std::to_string(high) + "], is " +
                   std::to_string(value));
}

absl::Status CheckAddress(const std::string& address, const std::string& flag) {
  const absl::Status status = ParseListenAddress(address).status();
  if (status.ok()) return status;
  return MakeError(status.code(), ErrorReason::kOptionInvalid,
                   flag + " " + std::string(status.message()));
}

}  // namespace

absl::Status ServerOptions::Validate() const {
  CCST_RETURN_IF_ERROR(CheckAddress(listen, "--listen"));
  if (!metrics_listen.empty()) {
    CCST_RETURN_IF_ERROR(CheckAddress(metrics_listen, "--metrics-listen"));
  }
  CCST_RETURN_IF_ERROR(security.Validate(listen, metrics_listen));
  CCST_RETURN_IF_ERROR(CheckRange(max_connections, 1, 1'000'000, "--max-connections"));
  CCST_RETURN_IF_ERROR(
      CheckRange(max_connections_per_address, 1, 1'000'000, "--max-connections-per-address"));
  CCST_RETURN_IF_ERROR(
      Check(proxy_socket.size() < kLongestSocketPath, "--proxy-socket", "a path below 108 bytes"));
  CCST_RETURN_IF_ERROR(CheckRange(threads_per_job, 1, 1024, "--threads"));
  CCST_RETURN_IF_ERROR(
      CheckRange(runner.max_running_jobs, 1, kMaxRunningJobs, "--max-running-jobs"));
  CCST_RETURN_IF_ERROR(CheckRange(runner.max_queued_jobs, 0, 100'000, "--max-queued-jobs"));
  CCST_RETURN_IF_ERROR(
      CheckRange(runner.max_queued_jobs_per_caller, 0, 100'000, "--max-queued-jobs-per-caller"));
  CCST_RETURN_IF_ERROR(CheckRange(max_watchers_per_job, 1, 100'000, "--max-watchers-per-job"));
  // One stream of samples must fit the part of a caller.
  CCST_RETURN_IF_ERROR(
      CheckRange(streams.most_bytes, std::int64_t{4} << 20, kLargestBytes, "--max-stream-bytes"));
  CCST_RETURN_IF_ERROR(
      Check(streams.longest_write_seconds > 0.0 && streams.longest_write_seconds <= kLongestSeconds,
            "--max-write-duration", "above 0 and at most 1e9 seconds"));
  CCST_RETURN_IF_ERROR(
      CheckRange(max_job_memory_bytes, 0, kLargestBytes, "--max-job-memory-bytes"));
  CCST_RETURN_IF_ERROR(CheckRange(mesh_limits.max_bytes, 1, kLargestMesh, "--max-mesh-bytes"));
  CCST_RETURN_IF_ERROR(
      CheckRange(max_stored_mesh_bytes, 1, kLargestBytes, "--max-stored-mesh-bytes"));
  CCST_RETURN_IF_ERROR(CheckRange(max_data_bytes, 0, kLargestBytes, "--max-data-bytes"));
  CCST_RETURN_IF_ERROR(CheckRange(records.max_bytes, 1, kLargestBytes, "--max-record-bytes"));
  CCST_RETURN_IF_ERROR(
      CheckRange(records.max_owner_bytes, 1, kLargestBytes, "--max-record-bytes-per-caller"));
  for (const auto& [seconds, flag] : {std::pair(mesh_retention_seconds, "--mesh-retention"),
                                      std::pair(job_retention_seconds, "--job-retention")}) {
    CCST_RETURN_IF_ERROR(Check(seconds > 0.0 && seconds <= kLongestSeconds, flag,
                               "above 0 and at most 1e9 seconds"));
  }
  CCST_RETURN_IF_ERROR(CheckRange(request_limits.max_inline_mesh_bytes, 1, kLargestInlineMesh,
                                  "--max-inline-mesh-bytes"));
  CCST_RETURN_IF_ERROR(
      CheckRange(request_limits.max_texture_bytes, 1, kLargestTexture, "--max-texture-bytes"));
  CCST_RETURN_IF_ERROR(CheckRange(request_limits.max_sample_count, kMinSampleCount, kMaxSampleCount,
                                  "--max-sample-count"));
  CCST_RETURN_IF_ERROR(
      CheckRange(request_limits.max_iterations, 0, kMaxAlternations, "--max-iterations"));
  CCST_RETURN_IF_ERROR(
      CheckRange(mesh_limits.max_vertices, 3, kLargestCount, "--max-vertex-count"));
  CCST_RETURN_IF_ERROR(CheckRange(mesh_limits.max_faces, 1, kLargestCount, "--max-face-count"));
  CCST_RETURN_IF_ERROR(Check(
      request_limits.max_job_seconds > 0.0 && request_limits.max_job_seconds <= kLongestSeconds,
      "--max-job-duration", "above 0 and at most 1e9 seconds"));
  return Check(drain_timeout_seconds >= 0.0 && drain_timeout_seconds <= kLongestSeconds,
               "--drain-timeout", "in [0, 1e9] seconds");
}

MeshStoreOptions ServerOptions::MeshOptions() const {
  return {.max_mesh_bytes = mesh_limits.max_bytes,
          .max_stored_bytes = max_stored_mesh_bytes,
          .retention = absl::Seconds(mesh_retention_seconds),
          .decode_limits = mesh_limits,
          .records = records};
}

JobManagerOptions ServerOptions::JobOptions() const {
  return {
      .runner = runner,
      .max_watchers_per_job = max_watchers_per_job,
      .retention = absl::Seconds(job_retention_seconds),
      .memory_budget_bytes = max_job_memory_bytes > 0 ? max_job_memory_bytes : MachineMemory() / 2,
      .records = records};
}

GateOptions ServerOptions::ConnectionOptions(std::int64_t descriptors) const {
  GateOptions gate;
  gate.listen = listen;
  gate.proxy_socket = proxy_socket;
  gate.tls = security.tls;
  const std::int64_t others = std::min(kOtherDescriptors, descriptors / 2);
  const std::int64_t most = std::clamp<std::int64_t>(
      (descriptors - others) / ConnectionGate::kDescriptorsPerConnection, 1, max_connections);
  gate.max_connections = static_cast<int>(most);
  // Where descriptors are few, one address shall not have all of them.
  gate.max_connections_per_address =
      most == max_connections
          ? max_connections_per_address
          : static_cast<int>(std::clamp<std::int64_t>(most / 2, 1, max_connections_per_address));
  return gate;
}

std::int64_t ServerOptions::MaxDataBytes() const {
  return max_data_bytes > 0 ? max_data_bytes : kLargestBytes;
}

int DefaultMaxRunningJobs(int threads_per_job) {
  const int cores = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  return std::max(1, cores / std::max(1, threads_per_job));
}

}  // namespace ccst::server
