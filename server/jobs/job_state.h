#pragma once

#include <optional>

#include "server/store/records.h"

namespace ccst::server {

/// What can happen to a job.
enum class JobEvent {
  kTaken,      ///< A worker takes it.
  kCancel,     ///< The caller went away or asked to stop.
  kFinished,   ///< The run returned a whole result.
  kStopped,    ///< The run stopped because it was asked to.
  kFailed,     ///< The run was refused or broke.
  kDrainEnds,  ///< The server cannot wait any longer.
  kPutOff,     ///< The store fails the run, which is to be tried again.
};

/// The state after `event`; empty where the event cannot happen in `state`.
std::optional<JobState> NextState(JobState state, JobEvent event);

}  // namespace ccst::server
