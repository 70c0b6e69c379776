#pragma once

#include <cstdint>

#include "absl/status/statusor.h"
#include "ccst/v1/job.pb.h"
#include "core/sampling/sampling.h"
#include "proto/convert/violations.h"

namespace ccst {

/// The advertised limits a request is checked against; named as in `ServerLimits`.
struct RequestLimits {
  std::int64_t max_inline_mesh_bytes = std::int64_t{64} << 20;
  std::int64_t max_sample_count = kMaxSampleCount;
  int max_iterations = kMaxAlternations;
  double max_job_seconds = 3600.0;
  std::int64_t max_texture_bytes = std::int64_t{16} << 20;
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

}  // namespace ccst
