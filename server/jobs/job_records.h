#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "server/jobs/job.h"
#include "server/jobs/job_codec.h"
#include "server/store/records.h"

namespace ccst::server {

/// What a store keeps of jobs, there and back.
class JobRecords {
 public:
  /// `codec` outlives it.
  explicit JobRecords(const JobCodec& codec) : codec_(codec) {}

  /// Of a job accepted at `now`, QUEUED.
  JobRecord New(const std::string& id, const JobSpec& spec, absl::Time now) const;

  /// The record of `job`, accepted and answered at `now` with the result of `found`, whose spec is
  /// equal.
  JobRecord Answered(const JobRecord& job, const JobRecord& found, absl::Time now,
                     absl::Duration retention) const;

  /// What Store::EndJob() takes of a job that ends as `end` says and is kept for `retention`.
  JobRecord Ended(const Job& job, const JobView& end, absl::Duration retention) const;
  /// The same of a job that cannot even be read.
  JobRecord Failed(const JobRecord& record, const absl::Status& error, absl::Time now,
                   absl::Duration retention) const;
  std::string History(const Job& job) const { return codec_.encode_history(job.Reports()); }

  /// True when the job of `record` was asked for with the same mesh, image, options and origin as
  /// `spec`, whichever revision of the program wrote the record. Errors as SpecOf().
  absl::StatusOr<bool> IsOf(const JobRecord& record, const JobSpec& spec) const;

  /// DATA_LOSS STORAGE_FAILED where the record is damaged.
  absl::StatusOr<JobSpec> SpecOf(const JobRecord& record) const;
  absl::StatusOr<JobView> ViewOf(const JobRecord& record) const;
  absl::StatusOr<std::vector<AlternationReport>> ReportsOf(const std::string& history) const {
    return codec_.decode_history(history);
  }

 private:
  const JobCodec& codec_;
};

}  // namespace ccst::server
