#include "server/jobs/job_state.h"

#include <array>
#include <cstddef>

namespace ccst::server {
namespace {

using Cell = std::optional<JobState>;

constexpr Cell kNever = std::nullopt;
constexpr Cell kQueued = JobState::kQueued;
constexpr Cell kRunning = JobState::kRunning;
constexpr Cell kCancelling = JobState::kCancelling;
constexpr Cell kSucceeded = JobState::kSucceeded;
constexpr Cell kFailed = JobState::kFailed;
constexpr Cell kCancelled = JobState::kCancelled;

// Rows: states; columns: events, in the order of their enumerations. A run that finishes whole
// while it is being cancelled has won the race and keeps its result.
constexpr std::array<std::array<Cell, 7>, 6> kTable = {{
    //             taken     cancel       finished    stopped     failed   drain ends   put off
    /* queued */ {{kRunning, kCancelled, kNever, kNever, kNever, kCancelled, kNever}},
    /* running */ {{kNever, kCancelling, kSucceeded, kNever, kFailed, kCancelling, kQueued}},
    /* cancelling */
    {{kNever, kCancelling, kSucceeded, kCancelled, kFailed, kCancelling, kNever}},
    /* succeeded */ {{kNever, kSucceeded, kNever, kNever, kNever, kSucceeded, kNever}},
    /* failed */ {{kNever, kFailed, kNever, kNever, kNever, kFailed, kNever}},
    /* cancelled */ {{kNever, kCancelled, kNever, kNever, kNever, kCancelled, kNever}},
}};

}  // namespace

std::optional<JobState> NextState(JobState state, JobEvent event) {
  return kTable[static_cast<std::size_t>(state)][static_cast<std::size_t>(event)];
}

}  // namespace ccst::server
