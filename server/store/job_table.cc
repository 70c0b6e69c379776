#include "server/store/job_table.h"

#include <algorithm>
#include <utility>

#include "core/base/sha256.h"
#include "core/base/status.h"
#include "server/store/job_list_query.h"
#include "server/store/job_state_name.h"
#include "server/store/page_token.h"

namespace ccst::server {
namespace {

constexpr char kList[] = "jobs";

#define CCST_JOB_COLUMNS_                                                                 \
  "jobs.id, jobs.owner, request_id, display_name, jobs.mesh_sha256, texture_sha256, "     \
  "spec_digest, definition, state, jobs.create_time, start_time, end_time, expire_time, " \
  "outcome, samples_sha256, reusable, cached, definition_sha256"

std::optional<JobRecord> FirstOf(std::vector<JobRecord> jobs) {
  if (jobs.empty()) return std::nullopt;
  return std::move(jobs.front());
}

}  // namespace

absl::StatusOr<JobRecord> JobTable::Add(const JobRecord& job) {
  Transaction transaction(database_);
  CCST_RETURN_IF_ERROR(transaction.status());
  if (!job.request_id.empty()) {
    std::optional<JobRecord> same;
    CCST_ASSIGN_OR_RETURN(same, FindRequest(job.owner, job.request_id));
    if (same.has_value()) return *std::move(same);
  }
  CCST_RETURN_IF_ERROR(database_
                           .Cached("INSERT INTO jobs VALUES "
                                   "(?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)")
                           .Bind(job.id)
                           .Bind(job.owner)
                           .Bind(job.request_id)
                           .Bind(job.display_name)
                           .Bind(job.mesh_sha256)
                           .Bind(job.texture_sha256)
                           .Bind(job.spec_digest)
                           .Bind(Bytes{job.definition})
                           .Bind(JobStateName(job.state))
                           .Bind(job.create_time)
                           .Bind(job.start_time)
                           .Bind(job.end_time)
                           .Bind(job.expire_time)
                           .Bind(Bytes{job.outcome})
                           .Bind(job.samples_sha256)
                           .Bind(job.reusable)
                           .Bind(job.cached)
                           .Bind(Sha256Of(job.definition))
                           .Run());
  for (const auto& [name, value] : job.labels) {
    CCST_RETURN_IF_ERROR(database_.Cached("INSERT INTO job_labels VALUES (?, ?, ?, ?, ?, ?)")
                             .Bind(job.id)
                             .Bind(name)
                             .Bind(value)
                             .Bind(job.owner)
                             .Bind(job.mesh_sha256)
                             .Bind(job.create_time)
                             .Run());
  }
  // As it is stored: with times of whole microseconds.
  std::optional<JobRecord> stored;
  CCST_ASSIGN_OR_RETURN(stored, Get(job.id));
  CCST_RETURN_IF_ERROR(transaction.Commit());
  return *std::move(stored);
}

absl::Status JobTable::MarkCancelling(const std::string& id) {
  return database_.Cached("UPDATE jobs SET state = 'cancelling' WHERE id = ? AND state = 'queued'")
      .Bind(id)
      .Run();
}

absl::Status JobTable::End(const JobRecord& job, const std::string& history) {
  Transaction transaction(database_);
  CCST_RETURN_IF_ERROR(transaction.status());
  std::optional<JobRecord> stored;
  CCST_ASSIGN_OR_RETURN(stored, Get(job.id));
  if (!stored.has_value()) {
    return MakeError(absl::StatusCode::kNotFound, ErrorReason::kNotFound,
                     "there is no job " + job.id + " to end");
  }
  if (HasEnded(stored->state)) return absl::OkStatus();
  CCST_RETURN_IF_ERROR(
      database_
          .Cached("UPDATE jobs SET state = ?, start_time = ?, end_time = ?, expire_time = ?, "
                  "outcome = ?, samples_sha256 = ?, reusable = ?, cached = ? WHERE id = ?")
          .Bind(JobStateName(job.state))
          .Bind(job.start_time)
          .Bind(job.end_time)
          .Bind(job.expire_time)
          .Bind(Bytes{job.outcome})
          .Bind(job.samples_sha256)
          .Bind(job.reusable)
          .Bind(job.cached)
          .Bind(job.id)
          .Run());
  if (!history.empty()) {
    CCST_RETURN_IF_ERROR(database_.Cached("INSERT INTO job_histories VALUES (?, ?, ?)")
                             .Bind(job.id)
                             .Bind(Bytes{history})
                             .Bind(Sha256Of(history))
                             .Run());
  }
  return transaction.Commit();
}

absl::StatusOr<std::optional<JobRecord>> JobTable::Get(const std::string& id) {
  Statement statement = database_.Cached("SELECT " CCST_JOB_COLUMNS_ " FROM jobs WHERE id = ?");
  std::vector<JobRecord> jobs;
  CCST_ASSIGN_OR_RETURN(jobs, ReadAll(statement.Bind(id)));
  return FirstOf(std::move(jobs));
}

absl::StatusOr<std::optional<JobRecord>> JobTable::FindRequest(const std::string& owner,
                                                               const std::string& request_id) {
  Statement same = database_.Cached("SELECT " CCST_JOB_COLUMNS_
                                    " FROM jobs WHERE owner = ? AND request_id = ? AND "
                                    "request_id <> ''");
  std::vector<JobRecord> jobs;
  CCST_ASSIGN_OR_RETURN(jobs, ReadAll(same.Bind(owner).Bind(request_id)));
  if (jobs.empty()) return std::nullopt;
  return std::move(jobs.front());
}

absl::StatusOr<std::string> JobTable::GetHistory(const std::string& id) {
  Statement statement =
      database_.Cached("SELECT history, sha256 FROM job_histories WHERE job_id = ?");
  if (!statement.Bind(id).Next()) {
    CCST_RETURN_IF_ERROR(statement.status());
    return "";
  }
  // Histories are long, and SQLite's own check sees only how their pages hang together.
  std::string history = statement.String(0);
  if (Sha256Of(history) != statement.String(1)) {
    return MakeError(absl::StatusCode::kInternal, ErrorReason::kStorageFailed,
                     "the records are damaged: the history of job " + id);
  }
  return history;
}

absl::StatusOr<Page<JobRecord>> JobTable::List(const JobFilter& filter, int page_size,
                                               const std::string& page_token) {
  PageKey key;
  CCST_ASSIGN_OR_RETURN(key, ParsePageToken(kList, page_token));
  const int size = std::max(page_size, 1);
  Statement statement =
      JobListQuery(database_, CCST_JOB_COLUMNS_, filter, key, std::int64_t{size} + 1);
  Page<JobRecord> page;
  CCST_ASSIGN_OR_RETURN(page.records, ReadAll(statement));
  if (page.records.size() > static_cast<std::size_t>(size)) {
    page.records.pop_back();
    const JobRecord& last = page.records.back();
    page.next_token = MakePageToken(kList, {last.create_time, last.id});
  }
  return page;
}

absl::StatusOr<std::vector<JobRecord>> JobTable::Unfinished() {
  Statement statement = database_.Cached("SELECT " CCST_JOB_COLUMNS_
                                         " FROM jobs WHERE state IN ('queued', 'cancelling') "
                                         "ORDER BY create_time, id");
  return ReadAll(statement);
}

absl::StatusOr<std::optional<JobRecord>> JobTable::FindReusable(const std::string& spec_digest,
                                                                absl::Time now) {
  Statement statement =
      database_.Cached("SELECT " CCST_JOB_COLUMNS_
                       " FROM jobs WHERE reusable = 1 AND spec_digest = ? AND expire_time >= ? "
                       "ORDER BY create_time DESC, id DESC LIMIT 1");
  std::vector<JobRecord> jobs;
  CCST_ASSIGN_OR_RETURN(jobs, ReadAll(statement.Bind(spec_digest).Bind(now)));
  return FirstOf(std::move(jobs));
}

absl::Status JobTable::Delete(const std::string& id) {
  return database_.Cached("DELETE FROM jobs WHERE id = ?").Bind(id).Run();
}

absl::StatusOr<std::vector<std::string>> JobTable::Expired(absl::Time now, int limit) {
  Statement statement = database_.Cached(
      "SELECT id FROM jobs WHERE expire_time < ? AND state NOT IN ('queued', 'cancelling') "
      "ORDER BY expire_time LIMIT ?");
  statement.Bind(now).Bind(std::max(limit, 0));
  std::vector<std::string> ids;
  while (statement.Next()) ids.push_back(statement.String(0));
  CCST_RETURN_IF_ERROR(statement.status());
  return ids;
}

absl::StatusOr<bool> JobTable::RefersTo(const std::string& sha256) {
  Statement statement = database_.Cached(
      "SELECT 1 FROM jobs WHERE mesh_sha256 = ?1 UNION ALL "
      "SELECT 1 FROM jobs WHERE texture_sha256 = ?1 AND texture_sha256 <> '' UNION ALL "
      "SELECT 1 FROM jobs WHERE samples_sha256 = ?1 AND samples_sha256 <> ''");
  const bool found = statement.Bind(sha256).Next();
  CCST_RETURN_IF_ERROR(statement.status());
  return found;
}

absl::StatusOr<std::vector<JobRecord>> JobTable::ReadAll(Statement& statement) {
  std::vector<JobRecord> jobs;
  while (statement.Next()) {
    JobState state = JobState::kQueued;
    CCST_ASSIGN_OR_RETURN(state, ParseJobStateName(statement.String(8)));
    jobs.push_back({.id = statement.String(0),
                    .owner = statement.String(1),
                    .request_id = statement.String(2),
                    .display_name = statement.String(3),
                    .labels = {},
                    .mesh_sha256 = statement.String(4),
                    .texture_sha256 = statement.String(5),
                    .spec_digest = statement.String(6),
                    .definition = statement.String(7),
                    .state = state,
                    .create_time = statement.Time(9),
                    .start_time = statement.OptionalTime(10),
                    .end_time = statement.OptionalTime(11),
                    .expire_time = statement.OptionalTime(12),
                    .outcome = statement.String(13),
                    .samples_sha256 = statement.String(14),
                    .reusable = statement.Int(15) != 0,
                    .cached = statement.Int(16) != 0});
    // As histories: SQLite's own check does not see what is inside.
    const std::string sha256 = statement.String(17);
    jobs.back().damaged = !sha256.empty() && sha256 != Sha256Of(jobs.back().definition);
  }
  CCST_RETURN_IF_ERROR(statement.status());
  for (JobRecord& job : jobs) CCST_RETURN_IF_ERROR(ReadLabels(job));
  return jobs;
}

absl::Status JobTable::ReadLabels(JobRecord& job) {
  Statement statement = database_.Cached("SELECT name, value FROM job_labels WHERE job_id = ?");
  statement.Bind(job.id);
  while (statement.Next()) job.labels.emplace(statement.String(0), statement.String(1));
  return statement.status();
}

}  // namespace ccst::server
