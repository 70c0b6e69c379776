#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "server/store/records.h"
#include "server/store/sqlite.h"

namespace ccst::server {

/// What ReadMeshes() takes of the table `meshes`, in its order.
#define CCST_MESH_COLUMNS_ \
  "owner, sha256, size_bytes, display_name, create_time, expire_time, facts, row_sum"

/// The meshes of `statement`, which selects CCST_MESH_COLUMNS_. One whose sum does not fit is
/// `damaged`.
absl::StatusOr<std::vector<MeshRecord>> ReadMeshes(Statement& statement);

/// The sum of all that stays as it was put.
std::string SumOfMesh(const MeshRecord& mesh);

/// The meshes of an embedded store. The methods are those of Store; not thread-safe.
class MeshTable {
 public:
  explicit MeshTable(Database& database) : database_(database) {}

  absl::Status Put(const MeshRecord& mesh);
  absl::StatusOr<std::optional<MeshRecord>> Get(const std::string& owner,
                                                const std::string& sha256);
  absl::Status Touch(const std::string& owner, const std::vector<std::string>& sha256s,
                     absl::Time expire_time);
  absl::StatusOr<Page<MeshRecord>> List(const std::string& owner, int page_size,
                                        const std::string& page_token);
  absl::Status Delete(const std::string& owner, const std::string& sha256);
  absl::StatusOr<std::int64_t> SumOfBytes(const std::string& owner);
  absl::StatusOr<std::vector<MeshRecord>> DropExpired(absl::Time now, int limit);
  absl::StatusOr<std::vector<MeshRecord>> Idle(const std::string& owner);
  absl::StatusOr<bool> IsInUse(const std::string& owner, const std::string& sha256);
  absl::StatusOr<bool> RefersTo(const std::string& sha256);

 private:
  Database& database_;
};

}  // namespace ccst::server
