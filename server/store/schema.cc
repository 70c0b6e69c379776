#include "server/store/schema.h"

#include <cstdint>

#include "absl/strings/str_cat.h"
#include "core/base/status.h"

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

}  // namespace

std::span<const std::string> SchemaMigrations() {
  static const std::string* const kScripts = new std::string[]{kVersion1, kVersion2};
  return {kScripts, 2};
}

absl::Status MigrateSchema(Database& database, std::span<const std::string> migrations) {
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
    CCST_RETURN_IF_ERROR(database.RunScript(migrations[static_cast<std::size_t>(version)]));
    CCST_RETURN_IF_ERROR(database.RunScript(absl::StrCat("PRAGMA user_version = ", version + 1)));
    CCST_RETURN_IF_ERROR(transaction.Commit());
  }
  return absl::OkStatus();
}

}  // namespace ccst::server
