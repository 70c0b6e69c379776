#include "client/lib/checked_outcome.h"

#include <cstdint>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/status.h"
#include "core/io/samples_digest.h"
#include "proto/convert/result.h"
#include "proto/convert/status.h"

namespace ccst {

absl::Status BrokenAnswer(const std::string& message) {
  return absl::DataLossError(absl::StrCat("broken answer: ", message));
}

absl::Status AsDataLoss(const absl::Status& status) {
  return status.ok() ? status : absl::DataLossError(status.message());
}

bool HasEnded(const v1::Job& job) {
  return job.state() == v1::Job::STATE_SUCCEEDED || job.state() == v1::Job::STATE_FAILED ||
         job.state() == v1::Job::STATE_CANCELLED;
}

absl::Status EndOf(const v1::Job& job) {
  switch (job.state()) {
    case v1::Job::STATE_SUCCEEDED:
      return absl::OkStatus();
    case v1::Job::STATE_FAILED: {
      absl::Status error = FromProto(job.error());
      return error.ok() ? absl::InternalError("the job failed without saying why") : error;
    }
    case v1::Job::STATE_CANCELLED:
      return MakeError(absl::StatusCode::kCancelled, ErrorReason::kCancelled,
                       "the server cancelled the job");
    default:
      return BrokenAnswer("the stream ended before the job did");
  }
}

absl::StatusOr<SampleOutcome> CheckedOutcome(const v1::Job& job, SampleSet samples) {
  CCST_RETURN_IF_ERROR(EndOf(job));
  auto figures = FromProto(job.result());
  if (!figures.ok()) return AsDataLoss(figures.status());
  const auto count = static_cast<std::int64_t>(samples.faces.size());
  if (count != figures->sample_count) {
    return BrokenAnswer(absl::StrCat(count, " samples, announced ", figures->sample_count));
  }
  if (static_cast<std::int64_t>(samples.triangles.size()) != figures->sample_mesh_face_count) {
    return BrokenAnswer(absl::StrCat(samples.triangles.size(), " triangles, announced ",
                                     figures->sample_mesh_face_count));
  }
  if (const std::string digest = SamplesDigest(samples); digest != figures->record.samples_sha256) {
    return BrokenAnswer(absl::StrCat("the samples' digest is ", digest, ", announced ",
                                     figures->record.samples_sha256));
  }
  SampleOutcome outcome;
  outcome.result = std::move(figures->result);
  outcome.result.samples = std::move(samples);
  outcome.record = std::move(figures->record);
  outcome.job_name = job.name();
  return outcome;
}

}  // namespace ccst
