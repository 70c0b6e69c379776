#pragma once

#include <functional>
#include <span>
#include <string>

#include "absl/status/statusor.h"
#include "core/density/image.h"
#include "core/io/mesh_limits.h"
#include "core/mesh/triangle_mesh.h"
#include "core/sampling/sampling.h"
#include "server/base/clock.h"
#include "server/jobs/job.h"

namespace ccst::server {

/// What a run is made of; tests put their own in.
struct RunDependencies {
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
};

/// Computes `job`, which is RUNNING, on this thread and ends it. Exceptions end it too: memory
/// that is not there with RESOURCE_EXHAUSTED OUT_OF_MEMORY, others with INTERNAL. The decoders
/// cannot be interrupted, sampling can (see RunControl).
void RunJob(Job& job, const RunDependencies& dependencies);

}  // namespace ccst::server
