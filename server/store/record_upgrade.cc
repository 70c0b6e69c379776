#include "server/store/record_upgrade.h"

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/base/sha256.h"
#include "core/base/status.h"
#include "server/formats/earlier_formats.h"
#include "server/store/job_rows.h"
#include "server/store/mesh_table.h"
#include "server/store/records.h"

namespace ccst::server {
namespace {

std::int64_t Length(const std::string& bytes) { return static_cast<std::int64_t>(bytes.size()); }

// The row that follows row `last` of a table; by rows, as damage leaves their numbers alone.
absl::StatusOr<std::optional<std::int64_t>> NextRow(Statement statement, std::int64_t last) {
  if (statement.Bind(last).Next()) return statement.Int(0);
  CCST_RETURN_IF_ERROR(statement.status());
  return std::nullopt;
}

// A history as it is found in its table.
struct History {
  std::string sha256;  // Empty: there is none.
  std::string bytes;
};

absl::StatusOr<History> HistoryOf(Database& database, std::int64_t row) {
  Statement statement = database.Cached(
      "SELECT history_sha256, history FROM jobs LEFT JOIN histories ON sha256 = history_sha256 "
      "WHERE jobs.rowid = ?");
  History history;
  if (statement.Bind(row).Next()) {
    history.sha256 = statement.String(0);
    history.bytes = statement.String(1);
  }
  CCST_RETURN_IF_ERROR(statement.status());
  return history;
}

// Puts the history in its present format where it is whole.
absl::StatusOr<History> UpgradeHistoryOf(Database& database, History history) {
  if (history.sha256.empty() || Sha256Of(history.bytes) != history.sha256) return history;
  auto bytes = UpgradeHistory(history.bytes);
  if (!bytes.ok() || bytes->empty()) return history;
  History upgraded{.sha256 = Sha256Of(*bytes), .bytes = *std::move(bytes)};
  CCST_RETURN_IF_ERROR(database.Cached("INSERT OR IGNORE INTO histories VALUES (?, ?)")
                           .Bind(upgraded.sha256)
                           .Bind(Bytes{upgraded.bytes})
                           .Run());
  return upgraded;
}

// What ReadJobs() and ReadMeshes() read are columns of version 4; once they read later ones, this
// needs its own.
absl::Status UpgradeJob(Database& database, std::int64_t row) {
  std::vector<JobRecord> jobs;
  {
    Statement statement = database.Cached("SELECT " CCST_JOB_COLUMNS_ " FROM jobs WHERE rowid = ?");
    CCST_ASSIGN_OR_RETURN(jobs, ReadJobs(database, statement.Bind(row)));
  }
  if (jobs.empty() || jobs.front().damaged) return absl::OkStatus();
  JobRecord job = std::move(jobs.front());
  auto definition = UpgradeDefinition(job.definition);
  auto outcome = UpgradeOutcome(job.outcome);
  if (!definition.ok() || !outcome.ok()) return absl::OkStatus();
  History before;
  CCST_ASSIGN_OR_RETURN(before, HistoryOf(database, row));
  const std::int64_t length = Length(job.definition) + Length(job.outcome) + Length(before.bytes);
  History history;
  CCST_ASSIGN_OR_RETURN(history, UpgradeHistoryOf(database, std::move(before)));
  job.definition = *std::move(definition);
  job.outcome = *std::move(outcome);
  return database
      .Cached(
          "UPDATE jobs SET definition = ?, definition_sha256 = ?, request_sum = ?, "
          "outcome = ?, end_sum = ?, history_sha256 = ?, record_bytes = record_bytes + ? "
          "WHERE rowid = ?")
      .Bind(Bytes{job.definition})
      .Bind(Sha256Of(job.definition))
      .Bind(SumOfRequest(job))
      .Bind(Bytes{job.outcome})
      .Bind(SumOfEnd(job, history.sha256))
      .Bind(history.sha256)
      .Bind(Length(job.definition) + Length(job.outcome) + Length(history.bytes) - length)
      .Bind(row)
      .Run();
}

absl::Status UpgradeMesh(Database& database, std::int64_t row) {
  std::vector<MeshRecord> meshes;
  {
    Statement statement =
        database.Cached("SELECT " CCST_MESH_COLUMNS_ " FROM meshes WHERE rowid = ?");
    CCST_ASSIGN_OR_RETURN(meshes, ReadMeshes(statement.Bind(row)));
  }
  if (meshes.empty() || meshes.front().damaged) return absl::OkStatus();
  MeshRecord mesh = std::move(meshes.front());
  auto facts = UpgradeFacts(mesh.facts);
  if (!facts.ok()) return absl::OkStatus();
  const std::int64_t longer = Length(*facts) - Length(mesh.facts);
  mesh.facts = *std::move(facts);
  return database
      .Cached(
          "UPDATE meshes SET facts = ?, row_sum = ?, record_bytes = record_bytes + ? "
          "WHERE rowid = ?")
      .Bind(Bytes{mesh.facts})
      .Bind(SumOfMesh(mesh))
      .Bind(longer)
      .Bind(row)
      .Run();
}

// Calls `upgrade` with each row that `next` tells of.
template <typename Next, typename Upgrade>
absl::Status ForEachRow(const Next& next, const Upgrade& upgrade) {
  std::int64_t last = std::numeric_limits<std::int64_t>::min();
  while (true) {
    std::optional<std::int64_t> row;
    CCST_ASSIGN_OR_RETURN(row, next(last));
    if (!row.has_value()) return absl::OkStatus();
    CCST_RETURN_IF_ERROR(upgrade(*row));
    last = *row;
  }
}

}  // namespace

absl::Status UpgradeRecords(Database& database) {
  CCST_RETURN_IF_ERROR(ForEachRow(
      [&](std::int64_t last) {
        return NextRow(
            database.Cached("SELECT rowid FROM jobs WHERE rowid > ? ORDER BY rowid LIMIT 1"), last);
      },
      [&](std::int64_t row) { return UpgradeJob(database, row); }));
  CCST_RETURN_IF_ERROR(ForEachRow(
      [&](std::int64_t last) {
        return NextRow(
            database.Cached("SELECT rowid FROM meshes WHERE rowid > ? ORDER BY rowid LIMIT 1"),
            last);
      },
      [&](std::int64_t row) { return UpgradeMesh(database, row); }));
  return database.RunScript(
      "DELETE FROM histories WHERE NOT EXISTS "
      "(SELECT 1 FROM jobs WHERE history_sha256 = histories.sha256 AND history_sha256 <> '')");
}

}  // namespace ccst::server
