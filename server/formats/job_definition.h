#pragma once

#include <optional>
#include <string>

#include <Eigen/Core>

#include "absl/status/statusor.h"
#include "core/sampling/options.h"

namespace ccst::server {

/// What was asked of a job, apart from what its record has columns for: mesh, image, names, labels.
struct JobDefinition {
  SamplingOptions options;                ///< With defaults filled in, without an image.
  std::optional<Eigen::Vector3d> origin;  ///< What the caller subtracted from all positions.
  /// The job is cancelled when nobody watched it for this long [s].
  std::optional<double> abandon_seconds;
  bool ends_with_caller = false;  ///< Cancelled when its first watcher goes, or the server does.
};

/// As bytes of a ccst.store.v1.Definition; equal definitions give equal ones. `thread_count` is the
/// server's matter and left out.
std::string EncodeDefinition(const JobDefinition& definition);
/// @errors DATA_LOSS STORAGE_FAILED the bytes are none
absl::StatusOr<JobDefinition> DecodeDefinition(const std::string& bytes);

}  // namespace ccst::server
