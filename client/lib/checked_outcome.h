#pragma once

#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "ccst/v1/job.pb.h"
#include "client/lib/outcome.h"

namespace ccst {

/// True in a state that never changes.
bool HasEnded(const v1::Job& job);

/// How a job that has ended ended: OK when it succeeded, `Job.error` when it failed, CANCELLED.
/// @errors those, and DATA_LOSS when it has not ended
absl::Status EndOf(const v1::Job& job);

/// The outcome of a job that succeeded and whose samples were all received: as many as announced,
/// with the digest announced. Positions are left as they are.
/// @errors those of EndOf() | DATA_LOSS (says what is missing or differs)
absl::StatusOr<SampleOutcome> CheckedOutcome(const v1::Job& job, SampleSet samples);

/// DATA_LOSS: an answer that contradicts itself.
absl::Status BrokenAnswer(const std::string& message);

/// `status` as DATA_LOSS when it is not OK: what is wrong with an answer is the fault of the server
/// or the wire, not of the caller.
absl::Status AsDataLoss(const absl::Status& status);

}  // namespace ccst
