#pragma once

#include <cstdint>

#include <Eigen/Core>

#include "absl/status/statusor.h"
#include "ccst/v1/job.pb.h"
#include "ccst/v1/sampling_service.pb.h"
#include "core/sampling/sampling.h"
#include "proto/convert/violations.h"

namespace ccst {

/// Largest `SampleRequest.preview_sample_count`.
inline constexpr int kMaxPreviewSampleCount = 65'536;

/// The advertised limits a request is checked against; named as in `ServerLimits`.
struct RequestLimits {
  std::int64_t max_inline_mesh_bytes = std::int64_t{64} << 20;
  std::int64_t max_sample_count = kMaxSampleCount;
  int max_iterations = kMaxAlternations;
  double max_job_seconds = 3600.0;
  std::int64_t max_texture_bytes = std::int64_t{16} << 20;
};

/// A checked `SampleRequest`, without the mesh's bytes.
struct SampleCall {
  SamplingOptions options;
  int preview_sample_count = 0;
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  bool has_origin = false;
};

/// `time_limit` is set where the options have one; `thread_count` does not travel, and neither does
/// a decoded image.
v1::SamplingOptions ToProto(const SamplingOptions& options);

/// Fills in defaults, and adds everything wrong to `violations` under `path` (for example
/// `options`); the value returned is meaningless then.
SamplingOptions FromProto(const v1::SamplingOptions& options, const RequestLimits& limits,
                          const std::string& path, Violations& violations);

/// INVALID_ARGUMENT with all violations, see Violations::ToStatus().
absl::StatusOr<SamplingOptions> FromProto(const v1::SamplingOptions& options,
                                          const RequestLimits& limits = {});
absl::StatusOr<SampleCall> FromProto(const v1::SampleRequest& request,
                                     const RequestLimits& limits = {});

}  // namespace ccst
