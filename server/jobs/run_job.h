#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string>

#include "absl/status/statusor.h"
#include "core/density/image.h"
#include "core/io/mesh_limits.h"
#include "core/mesh/triangle_mesh.h"
#include "core/sampling/sampling.h"
#include "server/base/clock.h"
#include "server/base/executor.h"
#include "server/jobs/job.h"
#include "server/metrics/job_observer.h"

namespace ccst::server {

/// What a mesh announces before it is decoded.
struct MeshCounts {
  std::int64_t vertices = 0;
  std::int64_t faces = 0;
};

/// What a run is made of; tests put their own in.
struct RunDependencies {
  /// Counts of a mesh of `size` bytes from its first ones, checked against the limits.
  std::function<absl::StatusOr<MeshCounts>(std::span<const char> start, std::int64_t size,
                                           const MeshLimits&)>
      count;
  /// As DecodeDraco().
  std::function<absl::StatusOr<TriangleMesh>(std::span<const char>, const MeshLimits&)> decode;
  /// As DecodeImage(), for texture densities.
  std::function<absl::StatusOr<Image>(std::span<const char>)> decode_image;
  /// As SampleSurface().
  std::function<absl::StatusOr<SamplingResult>(const TriangleMesh&, const SamplingOptions&,
                                               const RunControl&)>
      sample;
  /// As SamplesDigest().
  std::function<std::string(const SampleSet&)> digest;
  Clock clock;
  MeshLimits mesh_limits;
  int threads_per_job = 1;
};

/// What one run needs besides.
struct RunInputs {
  /// The bytes stored under a digest.
  std::function<absl::StatusOr<std::string>(const std::string& sha256)> load;
  /// Where decoders run, which cannot be interrupted: a job that is stopped leaves them behind.
  Executor& decoders;
  /// The job's memory, which what is left behind still uses.
  std::shared_ptr<void> grant;
  JobObserver& observer;
};

/// Computes `job`, which is RUNNING, on this thread. Its samples are in `run.samples` of the
/// result. A stop is answered within 100 ms. Exceptions become errors: memory that is not there
/// RESOURCE_EXHAUSTED OUT_OF_MEMORY, others INTERNAL.
absl::StatusOr<JobResult> RunJob(Job& job, const RunDependencies& dependencies,
                                 const RunInputs& inputs);

}  // namespace ccst::server
