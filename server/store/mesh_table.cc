#include "server/store/mesh_table.h"

#include <algorithm>
#include <cstdint>
#include <utility>

#include "core/base/status.h"
#include "server/store/page_token.h"
#include "server/store/record_bytes.h"
#include "server/store/row_sum.h"

namespace ccst::server {
namespace {

constexpr char kList[] = "meshes";

#define CCST_IDLE_                                                                    \
  "NOT EXISTS (SELECT 1 FROM jobs WHERE jobs.owner = meshes.owner AND mesh_sha256 = " \
  "sha256 AND state IN ('queued', 'cancelling'))"

}  // namespace

std::string SumOfMesh(const MeshRecord& mesh) {
  return RowSum()
      .Add(mesh.owner)
      .Add(mesh.sha256)
      .Add(mesh.size_bytes)
      .Add(mesh.display_name)
      .Add(mesh.create_time)
      .Add(mesh.facts)
      .Finish();
}

absl::StatusOr<std::vector<MeshRecord>> ReadMeshes(Statement& statement) {
  std::vector<MeshRecord> meshes;
  while (statement.Next()) {
    meshes.push_back({.owner = statement.String(0),
                      .sha256 = statement.String(1),
                      .size_bytes = statement.Int(2),
                      .display_name = statement.String(3),
                      .create_time = statement.Time(4),
                      .expire_time = statement.Time(5),
                      .facts = statement.String(6)});
    const std::string sum = statement.String(7);
    meshes.back().damaged = !sum.empty() && sum != SumOfMesh(meshes.back());
  }
  CCST_RETURN_IF_ERROR(statement.status());
  return meshes;
}

absl::Status MeshTable::Put(const MeshRecord& mesh) {
  return database_
      .Cached("INSERT INTO meshes (" CCST_MESH_COLUMNS_
              ", record_bytes) VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?) "
              // A conflict that replaces would run no trigger for the row that goes.
              "ON CONFLICT (owner, sha256) DO UPDATE SET size_bytes = excluded.size_bytes, "
              "display_name = excluded.display_name, create_time = excluded.create_time, "
              "expire_time = excluded.expire_time, facts = excluded.facts, "
              "row_sum = excluded.row_sum, record_bytes = excluded.record_bytes")
      .Bind(mesh.owner)
      .Bind(mesh.sha256)
      .Bind(mesh.size_bytes)
      .Bind(mesh.display_name)
      .Bind(mesh.create_time)
      .Bind(mesh.expire_time)
      .Bind(Bytes{mesh.facts})
      .Bind(SumOfMesh(mesh))
      .Bind(BytesOf(mesh))
      .Run();
}

absl::StatusOr<std::optional<MeshRecord>> MeshTable::Get(const std::string& owner,
                                                         const std::string& sha256) {
  Statement statement =
      database_.Cached("SELECT " CCST_MESH_COLUMNS_ " FROM meshes WHERE owner = ? AND sha256 = ?");
  std::vector<MeshRecord> meshes;
  CCST_ASSIGN_OR_RETURN(meshes, ReadMeshes(statement.Bind(owner).Bind(sha256)));
  if (meshes.empty()) return std::nullopt;
  return std::move(meshes.front());
}

absl::Status MeshTable::Touch(const std::string& owner, const std::vector<std::string>& sha256s,
                              absl::Time expire_time) {
  // One transaction is synchronized with the disk once.
  Transaction transaction(database_);
  CCST_RETURN_IF_ERROR(transaction.status());
  for (const std::string& sha256 : sha256s) {
    CCST_RETURN_IF_ERROR(database_
                             .Cached("UPDATE meshes SET expire_time = ?1 WHERE expire_time < ?1 "
                                     "AND owner = ?2 AND sha256 = ?3")
                             .Bind(expire_time)
                             .Bind(owner)
                             .Bind(sha256)
                             .Run());
  }
  return transaction.Commit();
}

absl::StatusOr<Page<MeshRecord>> MeshTable::List(const std::string& owner, int page_size,
                                                 const std::string& page_token) {
  PageKey key;
  CCST_ASSIGN_OR_RETURN(key, ParsePageToken(kList, page_token));
  const int size = std::max(page_size, 1);
  Statement statement =
      database_.Cached("SELECT " CCST_MESH_COLUMNS_
                       " FROM meshes WHERE owner = ? AND (create_time, sha256) < (?, ?)"
                       " ORDER BY create_time DESC, sha256 DESC LIMIT ?");
  statement.Bind(owner).Bind(key.create_time).Bind(key.id).Bind(std::int64_t{size} + 1);
  Page<MeshRecord> page;
  CCST_ASSIGN_OR_RETURN(page.records, ReadMeshes(statement));
  if (page.records.size() > static_cast<std::size_t>(size)) {
    page.records.pop_back();
    const MeshRecord& last = page.records.back();
    page.next_token = MakePageToken(kList, {last.create_time, last.sha256});
  }
  return page;
}

absl::Status MeshTable::Delete(const std::string& owner, const std::string& sha256) {
  return database_.Cached("DELETE FROM meshes WHERE owner = ? AND sha256 = ?")
      .Bind(owner)
      .Bind(sha256)
      .Run();
}

absl::StatusOr<std::int64_t> MeshTable::SumOfBytes(const std::string& owner) {
  Statement statement =
      database_.Cached("SELECT coalesce(sum(size_bytes), 0) FROM meshes WHERE owner = ?");
  if (statement.Bind(owner).Next()) return statement.Int(0);
  return statement.status();
}

absl::StatusOr<std::vector<MeshRecord>> MeshTable::DropExpired(absl::Time now, int limit) {
  Transaction transaction(database_);
  CCST_RETURN_IF_ERROR(transaction.status());
  std::vector<MeshRecord> expired;
  std::vector<std::int64_t> rows;  // Which damage leaves as they are, other than digests.
  {
    Statement statement =
        database_.Cached("SELECT rowid FROM meshes WHERE expire_time < ? AND " CCST_IDLE_
                         " ORDER BY expire_time LIMIT ?");
    statement.Bind(now).Bind(std::max(limit, 0));
    while (statement.Next()) rows.push_back(statement.Int(0));
    CCST_RETURN_IF_ERROR(statement.status());
  }
  for (const std::int64_t row : rows) {
    {
      Statement statement =
          database_.Cached("SELECT " CCST_MESH_COLUMNS_ " FROM meshes WHERE rowid = ?");
      std::vector<MeshRecord> meshes;
      CCST_ASSIGN_OR_RETURN(meshes, ReadMeshes(statement.Bind(row)));
      expired.insert(expired.end(), meshes.begin(), meshes.end());
    }
    CCST_RETURN_IF_ERROR(database_.Cached("DELETE FROM meshes WHERE rowid = ?").Bind(row).Run());
  }
  CCST_RETURN_IF_ERROR(transaction.Commit());
  return expired;
}

absl::StatusOr<std::vector<MeshRecord>> MeshTable::Idle(const std::string& owner) {
  // Every use moves the expiry, so it tells when the last one was.
  Statement statement =
      database_.Cached("SELECT " CCST_MESH_COLUMNS_ " FROM meshes WHERE owner = ? AND " CCST_IDLE_
                       " ORDER BY expire_time, create_time, sha256");
  return ReadMeshes(statement.Bind(owner));
}

absl::StatusOr<bool> MeshTable::IsInUse(const std::string& owner, const std::string& sha256) {
  Statement statement = database_.Cached(
      "SELECT 1 FROM jobs WHERE owner = ? AND mesh_sha256 = ? AND state IN ('queued', "
      "'cancelling')");
  const bool found = statement.Bind(owner).Bind(sha256).Next();
  CCST_RETURN_IF_ERROR(statement.status());
  return found;
}

absl::StatusOr<bool> MeshTable::RefersTo(const std::string& sha256) {
  Statement statement = database_.Cached("SELECT 1 FROM meshes WHERE sha256 = ?");
  const bool found = statement.Bind(sha256).Next();
  CCST_RETURN_IF_ERROR(statement.status());
  return found;
}

}  // namespace ccst::server
