#include "server/jobs/job_state.h"

#include <array>
#include <cstddef>

namespace ccst::server {
namespace {

using Cell = std::optional<JobState>;

constexpr Cell kNever = std::nullopt;
constexpr Cell kRunning = JobState::kRunning;
constexpr Cell kCancelling = JobState::kCancelling;
constexpr Cell kSucceeded = JobState::kSucceeded;
constexpr Cell kFailed = JobState::kFailed;
constexpr Cell kCancelled = JobState::kCancelled;

// Rows: states; columns: events, in the order of their enumerations. A run that finishes whole
// while it is being cancelled has won the race and keeps its result.
constexpr std::array<std::array<Cell, 6>, 6> kTable = {{
    //             taken     cancel       finished    stopped     failed   drain ends
    /* queued */ {{kRunning, kCancelled, kNever, kNever, kNever, kCancelled}},
    /* running */ {{kNever, kCancelling, kSucceeded, kNever, kFailed, kCancelling}},
    /* cancelling */ {{kNever, kCancelling, kSucceeded, kCancelled, kFailed, kCancelling}},
    /* succeeded */ {{kNever, kSucceeded, kNever, kNever, kNever, kSucceeded}},
    /* failed */ {{kNever, kFailed, kNever, kNever, kNever, kFailed}},
    /* cancelled */ {{kNever, kCancelled, kNever, kNever, kNever, kCancelled}},
}};

}  // namespace

std::optional<JobState> NextState(JobState state, JobEvent event) {
  return kTable[static_cast<std::size_t>(state)][static_cast<std::size_t>(event)];
}

}  // namespace ccst::server
