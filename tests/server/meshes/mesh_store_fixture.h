#pragma once

#include <optional>
#include <string>
#include <vector>

#include "server/meshes/mesh_store.h"
#include "tests/server/store/store_fixture.h"

namespace ccst::server {

/// A MeshStore over an embedded store, at a time of the test's. Meshes are Draco streams; where
/// only sizes matter, any bytes decode to a cube after AcceptAnyBytes().
class MeshStoreTest : public StoreTest {
 protected:
  MeshStoreTest();

  /// Of new stores.
  MeshStoreOptions options_;
  MeshDependencies dependencies_;
  void AcceptAnyBytes();
  MeshStore& meshes();

  /// Uploads `bytes` in two pieces.
  absl::StatusOr<StoredMesh> Upload(const std::string& owner, const std::string& bytes);
  /// Files that hold bytes of meshes, whole ones or parts.
  std::size_t FileCount() const;
  void AddJob(const std::string& owner, const std::string& sha256);
  void EndJobs();

  absl::Time now_ = At(0);

 private:
  std::vector<JobRecord> jobs_;
  std::optional<BlobPins> pins_;
  std::optional<MeshStore> meshes_;
};

/// What an upload of `bytes` announces.
MeshUpload Announced(const std::string& owner, const std::string& bytes);

/// A cube of this size as a Draco stream.
std::string CubeBytes(double scale = 1.0);

}  // namespace ccst::server
