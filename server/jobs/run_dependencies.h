#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <span>
#include <string>

#include "absl/status/statusor.h"
#include "core/density/image.h"
#include "core/io/byte_source.h"
#include "core/io/image_file.h"
#include "core/io/mesh_limits.h"
#include "core/mesh/triangle_mesh.h"
#include "core/sampling/sampling.h"
#include "server/base/clock.h"

namespace ccst::server {

/// What a mesh announces before it is decoded.
struct MeshCounts {
  std::int64_t vertices = 0;
  std::int64_t faces = 0;
  std::int64_t encoded_bytes = 0;  ///< As it is stored.
  std::int64_t decoder_bytes = 0;  ///< What the decoder takes beside the mesh that it makes.
  std::int64_t mesh_bytes = 0;     ///< The decoded mesh with its attributes.
  std::int64_t sample_bytes = 0;   ///< Values of attributes that every sample carries.
};

/// What a run is made of; tests put their own in.
struct RunDependencies {
  /// What a mesh announces, checked against the limits.
  std::function<absl::StatusOr<MeshCounts>(const ByteSource&, const MeshLimits&)> count;
  /// As ReadImageFacts(), for texture densities.
  std::function<absl::StatusOr<ImageFacts>(const ByteSource&)> image_facts;
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
  /// The longest that anything may be computed [s], > 0: what no option of a request bounds.
  double max_seconds = std::numeric_limits<double>::infinity();
};

}  // namespace ccst::server
