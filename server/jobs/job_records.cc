#include "server/jobs/job_records.h"

#include <cstdint>
#include <utility>

#include "core/base/printable_text.h"
#include "core/base/status.h"
#include "server/formats/job_definition.h"
#include "server/formats/job_outcome.h"

namespace ccst::server {
namespace {

// Of an outcome, and of each report of a history, encoded.
constexpr std::int64_t kOutcomeBytes = 1024;
constexpr std::int64_t kReportBytes = 64;

JobDefinition DefinitionOf(const JobSpec& spec) {
  return {.options = spec.options,
          .origin = spec.origin,
          .abandon_seconds = spec.abandon_seconds,
          .ends_with_caller = spec.ends_with_caller};
}

}  // namespace

JobRecord NewRecord(const std::string& id, const JobSpec& spec, absl::Time now) {
  JobRecord record;
  record.id = id;
  record.owner = spec.owner;
  record.request_id = spec.request_id;
  record.display_name = spec.display_name;
  record.labels = spec.labels;
  record.mesh_sha256 = spec.mesh_sha256;
  record.texture_sha256 = spec.texture_sha256;
  record.spec_digest = SpecDigest(spec);
  record.definition = EncodeDefinition(DefinitionOf(spec));
  record.create_time = now;
  record.expected_end_bytes = kOutcomeBytes + kReportBytes * spec.options.max_iterations;
  // After a crash it would only be cancelled.
  record.may_be_lost = spec.ends_with_caller;
  return record;
}

JobRecord AnsweredRecord(const JobRecord& job, const JobRecord& found, absl::Time now,
                         absl::Duration retention) {
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

JobRecord FailedRecord(const JobRecord& record, const absl::Status& error, absl::Time now,
                       absl::Duration retention) {
  JobRecord failed = record;
  failed.state = JobState::kFailed;
  failed.end_time = now;
  failed.expire_time = now + retention;
  failed.outcome =
      EncodeOutcome({.result = nullptr, .error = error, .phase = {}, .last_report = {}});
  return failed;
}

JobRecord EndedRecord(const Job& job, const JobView& end, absl::Duration retention) {
  JobRecord record;
  record.id = job.id();
  record.owner = job.spec().owner;
  record.state = end.state;
  record.start_time = end.start_time;
  record.end_time = end.end_time;
  record.expire_time = *end.end_time + retention;
  record.outcome = EncodeOutcome({.result = end.result,
                                  .error = end.error,
                                  .phase = end.phase,
                                  .last_report = end.last_report});
  record.samples_sha256 = end.samples_blob;
  record.reusable = end.result != nullptr && end.result->run.termination != Termination::kTimeLimit;
  return record;
}

absl::StatusOr<bool> IsOf(const JobRecord& record, const JobSpec& spec) {
  JobSpec earlier;
  CCST_ASSIGN_OR_RETURN(earlier, SpecOf(record));
  if (record.mesh_sha256 != spec.mesh_sha256 || record.texture_sha256 != spec.texture_sha256) {
    return false;
  }
  // As read: a definition that an earlier program wrote has got the defaults that it lacks.
  const auto sampling_of = [](const JobSpec& asked) {
    JobDefinition definition = DefinitionOf(asked);
    definition.abandon_seconds.reset();
    definition.ends_with_caller = false;
    return EncodeDefinition(definition);
  };
  return sampling_of(earlier) == sampling_of(spec);
}

absl::StatusOr<JobSpec> SpecOf(const JobRecord& record) {
  if (record.damaged) {
    return MakeError(absl::StatusCode::kDataLoss, ErrorReason::kStorageFailed,
                     "the records are damaged: what is stored of job " + PrintableText(record.id));
  }
  JobDefinition definition;
  CCST_ASSIGN_OR_RETURN(definition, DecodeDefinition(record.definition));
  JobSpec spec;
  spec.options = std::move(definition.options);
  spec.origin = definition.origin;
  spec.abandon_seconds = definition.abandon_seconds;
  spec.ends_with_caller = definition.ends_with_caller;
  spec.owner = record.owner;
  spec.share = record.owner;
  spec.request_id = record.request_id;
  spec.display_name = record.display_name;
  spec.labels = record.labels;
  spec.mesh_sha256 = record.mesh_sha256;
  spec.texture_sha256 = record.texture_sha256;
  return spec;
}

absl::StatusOr<JobView> ViewOf(const JobRecord& record) {
  JobOutcome outcome;
  CCST_ASSIGN_OR_RETURN(outcome, DecodeOutcome(record.outcome));
  JobView view;
  view.result = std::move(outcome.result);
  view.error = std::move(outcome.error);
  view.phase = outcome.phase;
  view.last_report = outcome.last_report;
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
