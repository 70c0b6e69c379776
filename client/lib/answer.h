#pragma once

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "ccst/v1/sampling_service.pb.h"
#include "client/lib/answer_bounds.h"
#include "client/lib/client.h"
#include "client/lib/outcome.h"

namespace ccst {

/// Puts the messages of one `Sample` stream together and checks them.
class Answer {
 public:
  /// `job` and `callbacks` must outlive the answer.
  Answer(const SampleJob& job, const SampleCallbacks& callbacks);

  /// Takes the next message. Events this version does not know are ignored.
  /// @errors DATA_LOSS chunks out of order, malformed, or more than asked for, see AnswerBounds
  absl::Status Take(const v1::SampleResponse& message);

  /// The outcome, after a stream that ended with OK.
  /// @errors `Job.error` of a failed job | CANCELLED | DATA_LOSS as Client::Sample()
  absl::StatusOr<SampleOutcome> Finish();

 private:
  const SampleJob& job_;
  const SampleCallbacks& callbacks_;
  const AnswerBounds bounds_;
  SampleSet samples_;
  v1::Job last_;
};

}  // namespace ccst
