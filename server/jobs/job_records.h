#pragma once

#include <string>

#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "server/jobs/job.h"
#include "server/store/records.h"

// What a store keeps of jobs, there and back. Histories are those of server/formats/job_history.h.

namespace ccst::server {

/// Of a job accepted at `now`, QUEUED.
JobRecord NewRecord(const std::string& id, const JobSpec& spec, absl::Time now);

/// The record of `job`, accepted and answered at `now` with the result of `found`, whose spec is
/// equal.
JobRecord AnsweredRecord(const JobRecord& job, const JobRecord& found, absl::Time now,
                         absl::Duration retention);

/// What Store::EndJob() takes of a job that ends as `end` says and is kept for `retention`.
JobRecord EndedRecord(const Job& job, const JobView& end, absl::Duration retention);
/// The same of a job that cannot even be read.
JobRecord FailedRecord(const JobRecord& record, const absl::Status& error, absl::Time now,
                       absl::Duration retention);

/// True when the job of `record` was asked for with the same mesh, image, options and origin as
/// `spec`, whichever revision of the program wrote the record. Errors as SpecOf().
absl::StatusOr<bool> IsOf(const JobRecord& record, const JobSpec& spec);

/// DATA_LOSS STORAGE_FAILED where the record is damaged.
absl::StatusOr<JobSpec> SpecOf(const JobRecord& record);
/// Errors the same.
absl::StatusOr<JobView> ViewOf(const JobRecord& record);

}  // namespace ccst::server
