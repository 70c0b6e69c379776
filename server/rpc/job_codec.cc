#include "server/rpc/job_codec.h"

#include <limits>
#include <memory>
#include <utility>

#include "ccst/v1/sampling_service.pb.h"
#include "core/base/status.h"
#include "google/protobuf/io/zero_copy_stream_impl_lite.h"
#include "google/protobuf/util/delimited_message_util.h"
#include "proto/convert/enums.h"
#include "proto/convert/options.h"
#include "proto/convert/progress.h"
#include "proto/convert/result.h"
#include "proto/convert/scalars.h"
#include "proto/convert/status.h"
#include "server/rpc/job_messages.h"

namespace ccst::server {
namespace {

// Set in the labels of a stored definition, which are stored apart, for a job of a `Sample` call.
constexpr char kEndsWithCaller[] = "ends-with-caller";

// What was accepted once must be readable when the limits are tighter.
constexpr RequestLimits kNoLimits = {.max_sample_count = std::numeric_limits<std::int64_t>::max(),
                                     .max_iterations = std::numeric_limits<int>::max(),
                                     .max_job_seconds = 1e12};

absl::Status Damaged(const char* what) {
  return MakeError(absl::StatusCode::kDataLoss, ErrorReason::kStorageFailed,
                   std::string("the stored ") + what + " of a job is damaged");
}

std::string EncodeDefinition(const JobSpec& spec) {
  v1::CreateJobRequest request;
  *request.mutable_spec()->mutable_options() = ccst::ToProto(spec.options);
  if (spec.origin.has_value()) {
    *request.mutable_spec()->mutable_origin() = ccst::ToProto(*spec.origin);
  }
  if (spec.abandon_seconds.has_value()) {
    *request.mutable_abandon_timeout() = DurationToProto(*spec.abandon_seconds);
  }
  if (spec.ends_with_caller) (*request.mutable_labels())[kEndsWithCaller] = "";
  return request.SerializeAsString();
}

absl::Status DecodeDefinition(const std::string& bytes, JobSpec& spec) {
  v1::CreateJobRequest request;
  if (!request.ParseFromString(bytes)) return Damaged("definition");
  // The image is stored apart, and options without one are refused.
  v1::SamplingOptions options = request.spec().options();
  const bool textured = options.has_texture();
  if (textured) options.mutable_texture()->set_image("-");
  CCST_ASSIGN_OR_RETURN(spec.options, FromProto(options, kNoLimits));
  spec.options.density.encoded_image = nullptr;
  if (request.spec().has_origin()) spec.origin = ccst::FromProto(request.spec().origin());
  if (request.has_abandon_timeout()) {
    spec.abandon_seconds = SecondsFromProto(request.abandon_timeout());
  }
  spec.ends_with_caller = request.labels().contains(kEndsWithCaller);
  return absl::OkStatus();
}

std::string EncodeOutcome(const JobView& view) {
  v1::Job job;
  if (view.result != nullptr) *job.mutable_result() = ToProto(*view.result, view.last_report);
  if (!view.error.ok()) *job.mutable_error() = ccst::ToProto(view.error);
  if (view.phase.has_value()) {
    *job.mutable_progress() =
        ccst::ToProto(view.last_report.value_or(AlternationReport{}), view.phase);
  }
  return job.SerializeAsString();
}

absl::Status DecodeOutcome(const std::string& bytes, JobView& view) {
  v1::Job job;
  if (!job.ParseFromString(bytes)) return Damaged("outcome");
  if (job.has_error()) view.error = ccst::FromProto(job.error());
  if (job.has_progress()) {
    view.phase = ccst::FromProto(job.progress().phase());
    view.last_report = ccst::FromProto(job.progress());
  }
  if (!job.has_result()) return absl::OkStatus();
  ResultFigures figures;
  CCST_ASSIGN_OR_RETURN(figures, ccst::FromProto(job.result()));
  view.result = std::make_shared<const JobResult>(
      JobResult{.run = std::move(figures.result),
                .sample_count = figures.sample_count,
                .triangle_count = figures.sample_mesh_face_count,
                .samples_sha256 = std::move(figures.record.samples_sha256),
                .samples_bytes = figures.record.samples_bytes,
                .queue_seconds = figures.record.queue_seconds,
                .decode_seconds = figures.record.decode_seconds,
                .total_seconds = figures.record.total_seconds,
                .warnings = std::move(figures.record.warnings)});
  return absl::OkStatus();
}

std::string EncodeHistory(std::span<const AlternationReport> reports) {
  std::string bytes;
  google::protobuf::io::StringOutputStream out(&bytes);
  for (const AlternationReport& report : reports) {
    google::protobuf::util::SerializeDelimitedToZeroCopyStream(
        ccst::ToProto(report, Phase::kRelaxing), &out);
  }
  return bytes;
}

absl::StatusOr<std::vector<AlternationReport>> DecodeHistory(const std::string& bytes) {
  google::protobuf::io::ArrayInputStream in(bytes.data(), static_cast<int>(bytes.size()));
  std::vector<AlternationReport> reports;
  while (true) {
    v1::IterationProgress progress;
    bool clean_end = false;
    if (!google::protobuf::util::ParseDelimitedFromZeroCopyStream(&progress, &in, &clean_end)) {
      if (clean_end) return reports;
      return Damaged("history");
    }
    reports.push_back(ccst::FromProto(progress));
  }
}

}  // namespace

JobCodec ProtoJobCodec() {
  return {.encode_definition = EncodeDefinition,
          .decode_definition = DecodeDefinition,
          .encode_outcome = EncodeOutcome,
          .decode_outcome = DecodeOutcome,
          .encode_history = EncodeHistory,
          .decode_history = DecodeHistory};
}

}  // namespace ccst::server
