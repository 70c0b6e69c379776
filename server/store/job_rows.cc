#include "server/store/job_rows.h"

#include <cstddef>

#include "core/base/sha256.h"
#include "core/base/status.h"
#include "server/store/job_state_name.h"
#include "server/store/row_sum.h"

namespace ccst::server {
namespace {

absl::Status ReadLabels(Database& database, JobRecord& job) {
  Statement statement = database.Cached("SELECT name, value FROM job_labels WHERE job_id = ?");
  statement.Bind(job.id);
  while (statement.Next()) job.labels.emplace(statement.String(0), statement.String(1));
  return statement.status();
}

}  // namespace

std::string SumOfRequest(const JobRecord& job) {
  RowSum sum;
  sum.Add(job.id).Add(job.owner).Add(job.request_id).Add(job.display_name).Add(job.mesh_sha256);
  sum.Add(job.texture_sha256).Add(job.spec_digest).Add(job.definition).Add(job.create_time);
  for (const auto& [name, value] : job.labels) sum.Add(name).Add(value);
  return sum.Finish();
}

std::string SumOfEnd(const JobRecord& job, const std::string& history_sha256) {
  if (!HasEnded(job.state)) return "";
  RowSum sum;
  sum.Add(job.id).Add(JobStateName(job.state)).Add(job.start_time).Add(job.end_time);
  sum.Add(job.expire_time).Add(job.outcome).Add(job.samples_sha256).Add(job.reusable);
  return sum.Add(job.cached).Add(history_sha256).Finish();
}

absl::StatusOr<std::vector<JobRecord>> ReadJobs(Database& database, Statement& statement) {
  // What the row says of its own parts.
  struct Sums {
    std::string definition;
    std::string request;
    std::string end;
    std::string history_sha256;
  };
  std::vector<JobRecord> jobs;
  std::vector<Sums> sums;
  while (statement.Next()) {
    const auto state = ParseJobStateName(statement.String(8));
    jobs.push_back({.id = statement.String(0),
                    .owner = statement.String(1),
                    .request_id = statement.String(2),
                    .display_name = statement.String(3),
                    .labels = {},
                    .mesh_sha256 = statement.String(4),
                    .texture_sha256 = statement.String(5),
                    .spec_digest = statement.String(6),
                    .definition = statement.String(7),
                    .state = state.value_or(JobState::kFailed),
                    .create_time = statement.Time(9),
                    .start_time = statement.OptionalTime(10),
                    .end_time = statement.OptionalTime(11),
                    .expire_time = statement.OptionalTime(12),
                    .outcome = statement.String(13),
                    .samples_sha256 = statement.String(14),
                    .reusable = statement.Int(15) != 0,
                    .cached = statement.Int(16) != 0,
                    .damaged = !state.ok(),
                    .starts = static_cast<int>(statement.Int(21))});
    sums.push_back({.definition = statement.String(17),
                    .request = statement.String(18),
                    .end = statement.String(19),
                    .history_sha256 = statement.String(20)});
  }
  CCST_RETURN_IF_ERROR(statement.status());
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    JobRecord& job = jobs[i];
    CCST_RETURN_IF_ERROR(ReadLabels(database, job));
    // SQLite's own check does not see what is inside. Sums are empty in rows of earlier versions.
    const auto differs = [](const std::string& stored, const std::string& now) {
      return !stored.empty() && stored != now;
    };
    job.damaged = job.damaged || differs(sums[i].definition, Sha256Of(job.definition)) ||
                  differs(sums[i].request, SumOfRequest(job)) ||
                  differs(sums[i].end, SumOfEnd(job, sums[i].history_sha256));
  }
  return jobs;
}

}  // namespace ccst::server
