#include "server/store/job_state_name.h"

#include <array>
#include <string>
#include <utility>

#include "core/base/status.h"

namespace ccst::server {
namespace {

constexpr std::array<std::pair<JobState, std::string_view>, 5> kNames = {{
    {JobState::kQueued, "queued"},
    {JobState::kCancelling, "cancelling"},
    {JobState::kSucceeded, "succeeded"},
    {JobState::kFailed, "failed"},
    {JobState::kCancelled, "cancelled"},
}};

}  // namespace

std::string_view JobStateName(JobState state) {
  for (const auto& [stored, name] : kNames) {
    if (stored == state) return name;
  }
  return "queued";
}

absl::StatusOr<JobState> ParseJobStateName(std::string_view name) {
  for (const auto& [state, stored] : kNames) {
    if (stored == name) return state;
  }
  return MakeError(absl::StatusCode::kInternal, ErrorReason::kStorageFailed,
                   "the records are damaged: a job has the state \"" + std::string(name) + "\"");
}

}  // namespace ccst::server
