#pragma once

#include <span>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/sampling/run_control.h"

namespace ccst::server {

/// All reports of a job as bytes of a ccst.store.v1.History, without positions. None give no bytes,
/// and no bytes give none.
std::string EncodeHistory(std::span<const AlternationReport> reports);
/// @errors DATA_LOSS STORAGE_FAILED the bytes are no history
absl::StatusOr<std::vector<AlternationReport>> DecodeHistory(const std::string& bytes);

}  // namespace ccst::server
