#pragma once

#include <string>

#include "absl/status/statusor.h"

namespace ccst::server {

/// What stores up to version 4 of the schema have: messages of the API, with meanings of their own.
/// Each of these reads one and gives the bytes of today that mean the same.
/// @errors DATA_LOSS STORAGE_FAILED or INVALID_ARGUMENT the bytes are none

/// A ccst.v1.CreateJobRequest without an image; a label `ends-with-caller` stands for that
/// property.
absl::StatusOr<std::string> UpgradeDefinition(const std::string& bytes);
/// A ccst.v1.Job with result, error and progress. No bytes, of a job that has not ended, stay none.
absl::StatusOr<std::string> UpgradeOutcome(const std::string& bytes);
/// Messages ccst.v1.IterationProgress, each behind its length.
absl::StatusOr<std::string> UpgradeHistory(const std::string& bytes);
/// A ccst.v1.Mesh without what its record has columns for.
absl::StatusOr<std::string> UpgradeFacts(const std::string& bytes);

}  // namespace ccst::server
