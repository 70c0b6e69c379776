#include "server/jobs/job_state.h"

#include <array>
#include <optional>

#include <gtest/gtest.h>

namespace ccst::server {
namespace {

using enum JobState;

constexpr std::array kStates = {kQueued, kRunning, kCancelling, kSucceeded, kFailed, kCancelled};
constexpr std::array kEvents = {JobEvent::kTaken,   JobEvent::kCancel, JobEvent::kFinished,
                                JobEvent::kStopped, JobEvent::kFailed, JobEvent::kDrainEnds,
                                JobEvent::kPutOff};

TEST(JobState, EveryCellIsAsDesigned) {
  constexpr auto kNever = std::optional<JobState>();
  // Columns as in kEvents.
  const std::array<std::array<std::optional<JobState>, 7>, 6> expected = {{
      {{kRunning, kCancelled, kNever, kNever, kNever, kCancelled, kNever}},
      {{kNever, kCancelling, kSucceeded, kNever, kFailed, kCancelling, kQueued}},
      {{kNever, kCancelling, kSucceeded, kCancelled, kFailed, kCancelling, kNever}},
      {{kNever, kSucceeded, kNever, kNever, kNever, kSucceeded, kNever}},
      {{kNever, kFailed, kNever, kNever, kNever, kFailed, kNever}},
      {{kNever, kCancelled, kNever, kNever, kNever, kCancelled, kNever}},
  }};
  for (std::size_t s = 0; s < kStates.size(); ++s) {
    for (std::size_t e = 0; e < kEvents.size(); ++e) {
      EXPECT_EQ(NextState(kStates[s], kEvents[e]), expected[s][e]) << "cell " << s << ", " << e;
    }
  }
}

TEST(JobState, EndedStatesNeverChange) {
  for (const JobState state : kStates) {
    for (const JobEvent event : kEvents) {
      const auto next = NextState(state, event);
      if (HasEnded(state)) {
        EXPECT_EQ(next.value_or(state), state);
      }
    }
  }
}

TEST(JobState, EveryStateCanEnd) {
  for (const JobState state : kStates) {
    const auto cancelled = NextState(state, JobEvent::kCancel);
    ASSERT_TRUE(cancelled.has_value());
    EXPECT_TRUE(HasEnded(*cancelled) ||
                HasEnded(NextState(*cancelled, JobEvent::kStopped).value_or(kRunning)));
  }
}

}  // namespace
}  // namespace ccst::server
