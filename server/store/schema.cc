#include "server/store/schema.h"

#include <cstdint>

#include "absl/strings/str_cat.h"
#include "core/base/status.h"
#include "server/store/record_upgrade.h"

namespace ccst::server {
namespace {

// Times are microseconds since 1970. Every list is read off an index in its order, and what the
// list is filtered by besides is in the index too, so that rows left out are never looked up.
constexpr char kVersion1[] = R"sql(
CREATE TABLE meshes (
  owner TEXT NOT NULL,
  sha256 TEXT NOT NULL,
  size_bytes INTEGER NOT NULL,
  display_name TEXT NOT NULL,
  create_time INTEGER NOT NULL,
  expire_time INTEGER NOT NULL,
  facts BLOB NOT NULL,
  PRIMARY KEY (owner, sha256)
);
CREATE INDEX meshes_list ON meshes (owner, create_time, sha256);
CREATE INDEX meshes_size ON meshes (owner, size_bytes);
CREATE INDEX meshes_expiry ON meshes (expire_time);
CREATE INDEX meshes_blob ON meshes (sha256);

CREATE TABLE jobs (
  id TEXT NOT NULL PRIMARY KEY,
  owner TEXT NOT NULL,
  request_id TEXT NOT NULL,
  display_name TEXT NOT NULL,
  mesh_sha256 TEXT NOT NULL,
  texture_sha256 TEXT NOT NULL,
  spec_digest TEXT NOT NULL,
  definition BLOB NOT NULL,
  state TEXT NOT NULL CHECK (state IN ('queued', 'cancelling', 'succeeded', 'failed', 'cancelled')),
  create_time INTEGER NOT NULL,
  start_time INTEGER,
  end_time INTEGER,
  expire_time INTEGER,
  outcome BLOB NOT NULL,
  samples_sha256 TEXT NOT NULL,
  reusable INTEGER NOT NULL,
  cached INTEGER NOT NULL
);
CREATE UNIQUE INDEX jobs_request ON jobs (owner, request_id) WHERE request_id <> '';
CREATE INDEX jobs_state ON jobs (id, state);
CREATE INDEX jobs_list ON jobs (create_time, id, state);
CREATE INDEX jobs_list_owner ON jobs (owner, create_time, id, state);
CREATE INDEX jobs_list_mesh ON jobs (mesh_sha256, create_time, id, owner, state);
CREATE INDEX jobs_unfinished ON jobs (create_time, id) WHERE state IN ('queued', 'cancelling');
CREATE INDEX jobs_mesh_in_use ON jobs (owner, mesh_sha256) WHERE state IN ('queued', 'cancelling');
CREATE INDEX jobs_reusable ON jobs (spec_digest, create_time, id) WHERE reusable = 1;
CREATE INDEX jobs_expiry ON jobs (expire_time) WHERE expire_time IS NOT NULL;
CREATE INDEX jobs_texture ON jobs (texture_sha256) WHERE texture_sha256 <> '';
CREATE INDEX jobs_samples ON jobs (samples_sha256) WHERE samples_sha256 <> '';

CREATE TABLE job_labels (
  job_id TEXT NOT NULL REFERENCES jobs (id) ON DELETE CASCADE,
  name TEXT NOT NULL,
  value TEXT NOT NULL,
  owner TEXT NOT NULL,
  mesh_sha256 TEXT NOT NULL,
  create_time INTEGER NOT NULL,
  PRIMARY KEY (job_id, name)
) WITHOUT ROWID;
CREATE INDEX job_labels_list ON job_labels (name, value, create_time, job_id, owner, mesh_sha256);

CREATE TABLE job_histories (
  job_id TEXT NOT NULL PRIMARY KEY REFERENCES jobs (id) ON DELETE CASCADE,
  history BLOB NOT NULL,
  sha256 TEXT NOT NULL
);
)sql";

// Empty for jobs of before, which are not checked.
constexpr char kVersion2[] =
    "ALTER TABLE jobs ADD COLUMN definition_sha256 TEXT NOT NULL DEFAULT ''";

// Jobs of before have not died with a process that counted.
constexpr char kVersion3[] = "ALTER TABLE jobs ADD COLUMN starts INTEGER NOT NULL DEFAULT 0";

// Sums tell damage; they are empty in rows of before, which are not checked. A history is stored
// once for all jobs that share it. What records take (record_bytes.cc) is summed up by owner, by
// triggers, so that whoever changes a row need not think of it; the room that a history may need
// counts from the beginning, so the true length takes its place when the job ends.
constexpr char kVersion4[] = R"sql(
ALTER TABLE jobs ADD COLUMN request_sum TEXT NOT NULL DEFAULT '';
ALTER TABLE jobs ADD COLUMN end_sum TEXT NOT NULL DEFAULT '';
ALTER TABLE jobs ADD COLUMN history_sha256 TEXT NOT NULL DEFAULT '';
ALTER TABLE jobs ADD COLUMN record_bytes INTEGER NOT NULL DEFAULT 0;
ALTER TABLE meshes ADD COLUMN row_sum TEXT NOT NULL DEFAULT '';
ALTER TABLE meshes ADD COLUMN record_bytes INTEGER NOT NULL DEFAULT 0;

CREATE TABLE histories (sha256 TEXT NOT NULL PRIMARY KEY, history BLOB NOT NULL);
INSERT OR IGNORE INTO histories SELECT sha256, history FROM job_histories;
UPDATE jobs SET history_sha256 =
  coalesce((SELECT sha256 FROM job_histories WHERE job_id = jobs.id), '');
DROP TABLE job_histories;
CREATE INDEX jobs_history ON jobs (history_sha256) WHERE history_sha256 <> '';
CREATE TRIGGER jobs_drop_history AFTER DELETE ON jobs
WHEN old.history_sha256 <> ''
  AND NOT EXISTS (SELECT 1 FROM jobs WHERE history_sha256 = old.history_sha256)
BEGIN
  DELETE FROM histories WHERE sha256 = old.history_sha256;
END;

UPDATE jobs SET record_bytes = 2048 + length(CAST(owner || request_id || display_name AS BLOB))
  + length(definition) + length(outcome)
  + coalesce((SELECT length(history) FROM histories WHERE sha256 = history_sha256), 0)
  + coalesce((SELECT sum(512 + 2 * length(CAST(name || value AS BLOB)))
              FROM job_labels WHERE job_id = jobs.id), 0);
UPDATE meshes SET record_bytes = 1024 + length(CAST(owner || display_name AS BLOB)) + length(facts);
CREATE TABLE record_totals (owner TEXT NOT NULL PRIMARY KEY, bytes INTEGER NOT NULL) WITHOUT ROWID;
INSERT INTO record_totals SELECT owner, sum(record_bytes) FROM
  (SELECT owner, record_bytes FROM jobs UNION ALL SELECT owner, record_bytes FROM meshes)
  GROUP BY owner;

CREATE TRIGGER jobs_count AFTER INSERT ON jobs BEGIN
  INSERT INTO record_totals VALUES (new.owner, new.record_bytes)
    ON CONFLICT (owner) DO UPDATE SET bytes = bytes + excluded.bytes;
END;
CREATE TRIGGER jobs_recount AFTER UPDATE OF record_bytes ON jobs BEGIN
  UPDATE record_totals SET bytes = bytes - old.record_bytes + new.record_bytes
    WHERE owner = new.owner;
END;
CREATE TRIGGER jobs_uncount AFTER DELETE ON jobs BEGIN
  UPDATE record_totals SET bytes = bytes - old.record_bytes WHERE owner = old.owner;
  DELETE FROM record_totals WHERE owner = old.owner AND bytes = 0;
END;
CREATE TRIGGER meshes_count AFTER INSERT ON meshes BEGIN
  INSERT INTO record_totals VALUES (new.owner, new.record_bytes)
    ON CONFLICT (owner) DO UPDATE SET bytes = bytes + excluded.bytes;
END;
CREATE TRIGGER meshes_recount AFTER UPDATE OF record_bytes ON meshes BEGIN
  UPDATE record_totals SET bytes = bytes - old.record_bytes + new.record_bytes
    WHERE owner = new.owner;
END;
CREATE TRIGGER meshes_uncount AFTER DELETE ON meshes BEGIN
  UPDATE record_totals SET bytes = bytes - old.record_bytes WHERE owner = old.owner;
  DELETE FROM record_totals WHERE owner = old.owner AND bytes = 0;
END;
)sql";

}  // namespace

std::span<const Migration> SchemaMigrations() {
  static constexpr Migration kMigrations[] = {{kVersion1},
                                              {kVersion2},
                                              {kVersion3},
                                              {kVersion4},
                                              // What rows carry is no message of the API any more.
                                              {"", UpgradeRecords}};
  return kMigrations;
}

absl::Status MigrateSchema(Database& database, std::span<const Migration> migrations) {
  std::int64_t version = 0;
  {
    Statement statement = database.Once("PRAGMA user_version");
    if (statement.Next()) version = statement.Int(0);
    CCST_RETURN_IF_ERROR(statement.status());
  }
  const auto newest = static_cast<std::int64_t>(migrations.size());
  if (version < 0 || version > newest) {
    return MakeError(
        absl::StatusCode::kFailedPrecondition, ErrorReason::kStorageFailed,
        absl::StrCat("the records have version ", version,
                     ", written by a newer program; this one knows versions up to ", newest));
  }
  for (; version < newest; ++version) {
    Transaction transaction(database);
    CCST_RETURN_IF_ERROR(transaction.status());
    const Migration& migration = migrations[static_cast<std::size_t>(version)];
    CCST_RETURN_IF_ERROR(database.RunScript(migration.script));
    if (migration.rewrite != nullptr) CCST_RETURN_IF_ERROR(migration.rewrite(database));
    CCST_RETURN_IF_ERROR(database.RunScript(absl::StrCat("PRAGMA user_version = ", version + 1)));
    CCST_RETURN_IF_ERROR(transaction.Commit());
  }
  return absl::OkStatus();
}

}  // namespace ccst::server
