#include "server/store/job_table.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "core/base/sha256.h"
#include "core/base/status.h"
#include "server/store/job_list_query.h"
#include "server/store/job_rows.h"
#include "server/store/job_state_name.h"
#include "server/store/page_token.h"
#include "server/store/record_bytes.h"

namespace ccst::server {
namespace {

constexpr char kList[] = "jobs";

std::int64_t Size(const std::string& bytes) { return static_cast<std::int64_t>(bytes.size()); }

std::optional<JobRecord> FirstOf(std::vector<JobRecord> jobs) {
  if (jobs.empty()) return std::nullopt;
  return std::move(jobs.front());
}

}  // namespace

absl::StatusOr<JobRecord> JobTable::Add(const JobRecord& job, const std::string& history) {
  Transaction transaction(database_);
  CCST_RETURN_IF_ERROR(transaction.status());
  if (!job.request_id.empty()) {
    std::optional<JobRecord> same;
    CCST_ASSIGN_OR_RETURN(same, FindRequest(job.owner, job.request_id));
    if (same.has_value()) return *std::move(same);
  }
  std::string history_sha256;
  CCST_ASSIGN_OR_RETURN(history_sha256, PutHistory(history));
  CCST_RETURN_IF_ERROR(
      database_
          .Cached("INSERT INTO jobs (id, owner, request_id, display_name, "
                  "mesh_sha256, texture_sha256, spec_digest, definition, state, "
                  "create_time, start_time, end_time, expire_time, outcome, "
                  "samples_sha256, reusable, cached, definition_sha256, "
                  "request_sum, end_sum, history_sha256, record_bytes) VALUES "
                  "(?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, "
                  "?, ?)")
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
          .Bind(SumOfRequest(job))
          .Bind(SumOfEnd(job, history_sha256))
          .Bind(history_sha256)
          .Bind(BytesOf(job) + (HasEnded(job.state) ? Size(history) : job.expected_end_bytes))
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
  return database_
      .Cached(
          "UPDATE jobs SET state = 'cancelling' WHERE id = ? AND state = "
          "'queued'")
      .Bind(id)
      .Run();
}

absl::Status JobTable::AddToStarts(const std::string& id, int change) {
  return database_.Cached("UPDATE jobs SET starts = max(starts + ?, 0) WHERE id = ?")
      .Bind(change)
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
  std::string history_sha256;
  CCST_ASSIGN_OR_RETURN(history_sha256, PutHistory(history));
  JobRecord ended = *std::move(stored);
  ended.state = job.state;
  ended.start_time = job.start_time;
  ended.end_time = job.end_time;
  ended.expire_time = job.expire_time;
  ended.outcome = job.outcome;
  ended.samples_sha256 = job.samples_sha256;
  ended.reusable = job.reusable;
  ended.cached = job.cached;
  CCST_RETURN_IF_ERROR(
      database_
          .Cached("UPDATE jobs SET state = ?, start_time = ?, end_time = ?, expire_time = ?, "
                  "outcome = ?, samples_sha256 = ?, reusable = ?, cached = ?, end_sum = ?, "
                  "history_sha256 = ?, record_bytes = ? WHERE id = ?")
          .Bind(JobStateName(ended.state))
          .Bind(ended.start_time)
          .Bind(ended.end_time)
          .Bind(ended.expire_time)
          .Bind(Bytes{ended.outcome})
          .Bind(ended.samples_sha256)
          .Bind(ended.reusable)
          .Bind(ended.cached)
          .Bind(SumOfEnd(ended, history_sha256))
          .Bind(history_sha256)
          .Bind(BytesOf(ended) + Size(history))
          .Bind(ended.id)
          .Run());
  return transaction.Commit();
}

absl::StatusOr<std::string> JobTable::PutHistory(const std::string& history) {
  if (history.empty()) return "";
  std::string sha256 = Sha256Of(history);
  // Jobs that one result answers share it; one that is damaged is healed.
  CCST_RETURN_IF_ERROR(database_
                           .Cached("INSERT INTO histories VALUES (?, ?) ON CONFLICT (sha256) DO "
                                   "UPDATE SET history = excluded.history "
                                   "WHERE history <> excluded.history")
                           .Bind(sha256)
                           .Bind(Bytes{history})
                           .Run());
  return sha256;
}

absl::StatusOr<std::optional<JobRecord>> JobTable::Get(const std::string& id) {
  Statement statement = database_.Cached("SELECT " CCST_JOB_COLUMNS_ " FROM jobs WHERE id = ?");
  std::vector<JobRecord> jobs;
  CCST_ASSIGN_OR_RETURN(jobs, ReadJobs(database_, statement.Bind(id)));
  return FirstOf(std::move(jobs));
}

absl::StatusOr<std::optional<JobRecord>> JobTable::FindRequest(const std::string& owner,
                                                               const std::string& request_id) {
  Statement same = database_.Cached("SELECT " CCST_JOB_COLUMNS_
                                    " FROM jobs WHERE owner = ? AND request_id = ? AND "
                                    "request_id <> ''");
  std::vector<JobRecord> jobs;
  CCST_ASSIGN_OR_RETURN(jobs, ReadJobs(database_, same.Bind(owner).Bind(request_id)));
  if (jobs.empty()) return std::nullopt;
  return std::move(jobs.front());
}

absl::StatusOr<std::string> JobTable::GetHistory(const std::string& id) {
  Statement statement = database_.Cached(
      "SELECT history_sha256, history FROM jobs LEFT JOIN histories ON sha256 = history_sha256 "
      "WHERE id = ?");
  if (!statement.Bind(id).Next()) {
    CCST_RETURN_IF_ERROR(statement.status());
    return "";
  }
  const std::string sha256 = statement.String(0);
  if (sha256.empty()) return "";
  // Histories are long, and SQLite's own check sees only how their pages hang together.
  std::string history = statement.String(1);
  if (Sha256Of(history) != sha256) {
    return MakeError(absl::StatusCode::kDataLoss, ErrorReason::kStorageFailed,
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
  CCST_ASSIGN_OR_RETURN(page.records, ReadJobs(database_, statement));
  if (page.records.size() > static_cast<std::size_t>(size)) {
    page.records.pop_back();
    const JobRecord& last = page.records.back();
    page.next_token = MakePageToken(kList, {last.create_time, last.id});
  }
  return page;
}

absl::StatusOr<std::vector<JobRecord>> JobTable::Unfinished() {
  // Without the index: a job that a damaged one does not name would not be run.
  Statement statement =
      database_.Cached("SELECT " CCST_JOB_COLUMNS_
                       " FROM jobs NOT INDEXED WHERE state IN ('queued', 'cancelling') "
                       "ORDER BY create_time, id");
  return ReadJobs(database_, statement);
}

absl::StatusOr<std::optional<JobRecord>> JobTable::FindReusable(const std::string& spec_digest,
                                                                absl::Time now) {
  Statement statement =
      database_.Cached("SELECT " CCST_JOB_COLUMNS_
                       " FROM jobs WHERE reusable = 1 AND spec_digest = ? AND expire_time >= ? "
                       "ORDER BY create_time DESC, id DESC LIMIT 1");
  std::vector<JobRecord> jobs;
  CCST_ASSIGN_OR_RETURN(jobs, ReadJobs(database_, statement.Bind(spec_digest).Bind(now)));
  return FirstOf(std::move(jobs));
}

absl::Status JobTable::Delete(const std::string& id) {
  return database_.Cached("DELETE FROM jobs WHERE id = ?").Bind(id).Run();
}

absl::StatusOr<std::vector<DroppedJob>> JobTable::DropExpired(absl::Time now, int limit) {
  Transaction transaction(database_);
  CCST_RETURN_IF_ERROR(transaction.status());
  std::vector<DroppedJob> dropped;
  std::vector<std::int64_t> rows;  // Which damage leaves as they are, other than ids.
  {
    Statement statement = database_.Cached(
        "SELECT id, samples_sha256, texture_sha256, mesh_sha256, rowid FROM jobs "
        "WHERE expire_time < ? AND state NOT IN ('queued', 'cancelling') "
        "ORDER BY expire_time LIMIT ?");
    statement.Bind(now).Bind(std::max(limit, 0));
    while (statement.Next()) {
      DroppedJob& job = dropped.emplace_back(DroppedJob{.id = statement.String(0), .blobs = {}});
      for (const int column : {1, 2, 3}) {
        std::string sha256 = statement.String(column);
        if (!sha256.empty()) job.blobs.push_back(std::move(sha256));
      }
      rows.push_back(statement.Int(4));
    }
    CCST_RETURN_IF_ERROR(statement.status());
  }
  for (const std::int64_t row : rows) {
    CCST_RETURN_IF_ERROR(database_.Cached("DELETE FROM jobs WHERE rowid = ?").Bind(row).Run());
  }
  CCST_RETURN_IF_ERROR(transaction.Commit());
  return dropped;
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

}  // namespace ccst::server
