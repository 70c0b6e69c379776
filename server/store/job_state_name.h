#pragma once

#include <string_view>

#include "absl/status/statusor.h"
#include "server/store/records.h"

namespace ccst::server {

/// The name a state is stored by. RUNNING is stored as QUEUED.
std::string_view JobStateName(JobState state);

/// @errors INTERNAL STORAGE_FAILED when it is no name of a stored state
absl::StatusOr<JobState> ParseJobStateName(std::string_view name);

}  // namespace ccst::server
