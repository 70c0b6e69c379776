#include "client/lib/answer.h"

#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/status.h"
#include "core/io/samples_digest.h"
#include "proto/convert/progress.h"
#include "proto/convert/result.h"
#include "proto/convert/samples.h"
#include "proto/convert/status.h"

namespace ccst {
namespace {

absl::Status Broken(const std::string& message) {
  return absl::DataLossError(absl::StrCat("broken answer: ", message));
}

// What is wrong with an answer is the server's fault or the wire's, not the caller's.
absl::Status AsDataLoss(const absl::Status& status) {
  return status.ok() ? status : absl::DataLossError(status.message());
}

}  // namespace

Answer::Answer(const SampleJob& job, const SampleCallbacks& callbacks)
    : job_(job), callbacks_(callbacks) {}

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
    case v1::SampleResponse::kSamples: {
      const auto had = static_cast<std::int64_t>(samples_.faces.size());
      if (had + message.samples().face_indices_size() > job_.options.sample_count) {
        return Broken(absl::StrCat("more than the ", job_.options.sample_count,
                                   " samples that were asked for"));
      }
      return AsDataLoss(AppendChunk(message.samples(), samples_));
    }
    case v1::SampleResponse::kSampleMesh:
      return AsDataLoss(AppendChunk(message.sample_mesh(), samples_));
    case v1::SampleResponse::kHeartbeat:
    case v1::SampleResponse::EVENT_NOT_SET:
      break;
  }
  return absl::OkStatus();
}

absl::StatusOr<SampleOutcome> Answer::Finish() {
  switch (last_.state()) {
    case v1::Job::STATE_SUCCEEDED:
      return Check(last_.result());
    case v1::Job::STATE_FAILED: {
      absl::Status error = FromProto(last_.error());
      return error.ok() ? absl::InternalError("the job failed without saying why") : error;
    }
    case v1::Job::STATE_CANCELLED:
      return MakeError(absl::StatusCode::kCancelled, ErrorReason::kCancelled,
                       "the server cancelled the job");
    default:
      return Broken("the stream ended before the job did");
  }
}

absl::StatusOr<SampleOutcome> Answer::Check(const v1::SamplingResult& result) {
  auto figures = FromProto(result);
  if (!figures.ok()) return AsDataLoss(figures.status());
  const auto count = static_cast<std::int64_t>(samples_.faces.size());
  if (count != job_.options.sample_count) {
    return Broken(absl::StrCat(count, " samples, asked for ", job_.options.sample_count));
  }
  if (static_cast<std::int64_t>(samples_.triangles.size()) != figures->sample_mesh_face_count) {
    return Broken(absl::StrCat(samples_.triangles.size(), " triangles, announced ",
                               figures->sample_mesh_face_count));
  }
  if (const std::string digest = SamplesDigest(samples_);
      digest != figures->record.samples_sha256) {
    return Broken(absl::StrCat("the samples' digest is ", digest, ", announced ",
                               figures->record.samples_sha256));
  }
  CCST_RETURN_IF_ERROR(PlaceSamples(job_.mesh, job_.origin, samples_));
  SampleOutcome outcome;
  outcome.result = std::move(figures->result);
  outcome.result.samples = std::move(samples_);
  outcome.record = std::move(figures->record);
  outcome.job_name = last_.name();
  return outcome;
}

}  // namespace ccst
