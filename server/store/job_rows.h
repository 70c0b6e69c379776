#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "server/store/records.h"
#include "server/store/sqlite.h"

namespace ccst::server {

/// What ReadJobs() takes of the table `jobs`, in its order.
#define CCST_JOB_COLUMNS_                                                                 \
  "jobs.id, jobs.owner, request_id, display_name, jobs.mesh_sha256, texture_sha256, "     \
  "spec_digest, definition, state, jobs.create_time, start_time, end_time, expire_time, " \
  "outcome, samples_sha256, reusable, cached, definition_sha256, request_sum, end_sum, "  \
  "history_sha256, starts"

/// The jobs of `statement`, which selects CCST_JOB_COLUMNS_, with their labels. One whose sums do
/// not fit is `damaged`.
absl::StatusOr<std::vector<JobRecord>> ReadJobs(Database& database, Statement& statement);

/// The sum of what a job is from the beginning.
std::string SumOfRequest(const JobRecord& job);
/// That of what its end adds; empty before.
std::string SumOfEnd(const JobRecord& job, const std::string& history_sha256);

}  // namespace ccst::server
