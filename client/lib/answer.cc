#include "client/lib/answer.h"

#include <cstdint>
#include <utility>

#include "absl/strings/str_cat.h"
#include "client/lib/checked_outcome.h"
#include "core/base/status.h"
#include "proto/convert/progress.h"

namespace ccst {

Answer::Answer(const SampleJob& job, const SampleCallbacks& callbacks)
    : job_(job), callbacks_(callbacks), bounds_(BoundsOf(job.options, job.mesh)) {}

absl::Status Answer::Take(const v1::SampleResponse& message) {
  switch (message.event_case()) {
    case v1::SampleResponse::kSnapshot:
      last_ = message.snapshot();
      if (callbacks_.on_snapshot) callbacks_.on_snapshot(last_);
      return absl::OkStatus();
    case v1::SampleResponse::kProgress:
      if (callbacks_.on_progress) callbacks_.on_progress(FromProto(message.progress()));
      return absl::OkStatus();
    case v1::SampleResponse::kPreview:
      if (callbacks_.on_preview) callbacks_.on_preview(message.preview());
      return absl::OkStatus();
    case v1::SampleResponse::kSamples:
      return AppendWithin(bounds_, message.samples(), samples_);
    case v1::SampleResponse::kSampleMesh:
      return AppendWithin(bounds_, message.sample_mesh(), samples_);
    case v1::SampleResponse::kHeartbeat:
    case v1::SampleResponse::EVENT_NOT_SET:
      break;
  }
  return absl::OkStatus();
}

absl::StatusOr<SampleOutcome> Answer::Finish() {
  CCST_RETURN_IF_ERROR(EndOf(last_));
  if (const std::size_t count = samples_.faces.size();
      static_cast<std::int64_t>(count) != job_.options.sample_count) {
    return BrokenAnswer(absl::StrCat(count, " samples, asked for ", job_.options.sample_count));
  }
  CCST_ASSIGN_OR_RETURN(SampleOutcome outcome, CheckedOutcome(last_, std::move(samples_)));
  CCST_RETURN_IF_ERROR(PlaceSamples(job_.mesh, job_.origin, outcome.result.samples));
  return outcome;
}

}  // namespace ccst
