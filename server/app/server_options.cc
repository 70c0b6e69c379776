#include "server/app/server_options.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <thread>

#include "core/base/status.h"

namespace ccst::server {
namespace {

// gRPC counts message sizes in 32 bits; a mebibyte is left for the rest of the request.
constexpr std::int64_t kLargestTexture = std::int64_t{256} << 20;
constexpr std::int64_t kLargestInlineMesh =
    std::numeric_limits<std::int32_t>::max() - kLargestTexture - (2 << 20);
constexpr std::int64_t kLargestCount = std::numeric_limits<std::int32_t>::max();
constexpr double kLongestSeconds = 1e9;

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

}  // namespace

absl::Status ServerOptions::Validate() const {
  CCST_RETURN_IF_ERROR(Check(listen.rfind(':') != std::string::npos, "--listen", "HOST:PORT"));
  CCST_RETURN_IF_ERROR(
      Check(metrics_listen.empty() || metrics_listen.rfind(':') != std::string::npos,
            "--metrics-listen", "HOST:PORT"));
  CCST_RETURN_IF_ERROR(security.Validate(listen, metrics_listen));
  CCST_RETURN_IF_ERROR(CheckRange(threads_per_job, 1, 1024, "--threads"));
  CCST_RETURN_IF_ERROR(CheckRange(runner.max_running_jobs, 1, 1024, "--max-running-jobs"));
  CCST_RETURN_IF_ERROR(CheckRange(runner.max_queued_jobs, 0, 100'000, "--max-queued-jobs"));
  CCST_RETURN_IF_ERROR(CheckRange(runner.max_queued_bytes, 0,
                                  std::numeric_limits<std::int64_t>::max(),
                                  "--max-queued-mesh-bytes"));
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

int DefaultMaxRunningJobs(int threads_per_job) {
  const int cores = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  return std::max(1, cores / std::max(1, threads_per_job));
}

}  // namespace ccst::server
