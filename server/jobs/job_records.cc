#include "server/jobs/job_records.h"

#include <cstdint>

#include "core/base/printable_text.h"
#include "core/base/status.h"

namespace ccst::server {
namespace {

// Of an outcome, and of each report of a history, encoded.
constexpr std::int64_t kOutcomeBytes = 1024;
constexpr std::int64_t kReportBytes = 64;

}  // namespace

JobRecord JobRecords::New(const std::string& id, const JobSpec& spec, absl::Time now) const {
  JobRecord record;
  record.id = id;
  record.owner = spec.owner;
  record.request_id = spec.request_id;
  record.display_name = spec.display_name;
  record.labels = spec.labels;
  record.mesh_sha256 = spec.mesh_sha256;
  record.texture_sha256 = spec.texture_sha256;
  record.spec_digest = SpecDigest(spec);
  record.definition = codec_.encode_definition(spec);
  record.create_time = now;
  record.expected_end_bytes = kOutcomeBytes + kReportBytes * spec.options.max_iterations;
  return record;
}

JobRecord JobRecords::Answered(const JobRecord& job, const JobRecord& found, absl::Time now,
                               absl::Duration retention) const {
  JobRecord answered = job;
  answered.state = JobState::kSucceeded;
  answered.start_time = now;
  answered.end_time = now;
  answered.expire_time = now + retention;
  answered.outcome = found.outcome;
  answered.samples_sha256 = found.samples_sha256;
  answered.reusable = true;
  answered.cached = true;
  return answered;
}

JobRecord JobRecords::Failed(const JobRecord& record, const absl::Status& error, absl::Time now,
                             absl::Duration retention) const {
  JobView end;
  end.error = error;
  JobRecord failed = record;
  failed.state = JobState::kFailed;
  failed.end_time = now;
  failed.expire_time = now + retention;
  failed.outcome = codec_.encode_outcome(end);
  return failed;
}

JobRecord JobRecords::Ended(const Job& job, const JobView& end, absl::Duration retention) const {
  JobRecord record;
  record.id = job.id();
  record.owner = job.spec().owner;
  record.state = end.state;
  record.start_time = end.start_time;
  record.end_time = end.end_time;
  record.expire_time = *end.end_time + retention;
  record.outcome = codec_.encode_outcome(end);
  record.samples_sha256 = end.samples_blob;
  record.reusable = end.result != nullptr && end.result->run.termination != Termination::kTimeLimit;
  return record;
}

absl::StatusOr<bool> JobRecords::IsOf(const JobRecord& record, const JobSpec& spec) const {
  JobSpec earlier;
  CCST_ASSIGN_OR_RETURN(earlier, SpecOf(record));
  if (record.mesh_sha256 != spec.mesh_sha256 || record.texture_sha256 != spec.texture_sha256) {
    return false;
  }
  // Encoded, read and encoded again: a definition that an earlier program wrote gets what was a
  // default then, and both lose the same digits of durations.
  const auto definition_of = [this](JobSpec written) {
    written.abandon_seconds.reset();
    written.ends_with_caller = false;
    return codec_.encode_definition(written);
  };
  JobSpec now;
  CCST_RETURN_IF_ERROR(codec_.decode_definition(definition_of(spec), now));
  return definition_of(earlier) == definition_of(now);
}

absl::StatusOr<JobSpec> JobRecords::SpecOf(const JobRecord& record) const {
  if (record.damaged) {
    return MakeError(absl::StatusCode::kDataLoss, ErrorReason::kStorageFailed,
                     "the records are damaged: what is stored of job " + PrintableText(record.id));
  }
  JobSpec spec;
  CCST_RETURN_IF_ERROR(codec_.decode_definition(record.definition, spec));
  spec.owner = record.owner;
  spec.share = record.owner;
  spec.request_id = record.request_id;
  spec.display_name = record.display_name;
  spec.labels = record.labels;
  spec.mesh_sha256 = record.mesh_sha256;
  spec.texture_sha256 = record.texture_sha256;
  return spec;
}

absl::StatusOr<JobView> JobRecords::ViewOf(const JobRecord& record) const {
  JobView view;
  CCST_RETURN_IF_ERROR(codec_.decode_outcome(record.outcome, view));
  view.state = record.state;
  view.cached = record.cached;
  view.samples_blob = record.samples_sha256;
  view.create_time = record.create_time;
  view.start_time = record.start_time;
  view.end_time = record.end_time;
  view.expire_time = record.expire_time;
  return view;
}

}  // namespace ccst::server
