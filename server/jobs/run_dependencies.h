#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>

#include "absl/status/statusor.h"
#include "core/density/image.h"
#include "core/io/mesh_limits.h"
#include "core/mesh/triangle_mesh.h"
#include "core/sampling/sampling.h"
#include "server/base/clock.h"

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

}  // namespace ccst::server
