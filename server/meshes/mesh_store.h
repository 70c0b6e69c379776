#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "core/io/mesh_limits.h"
#include "core/mesh/triangle_mesh.h"
#include "server/base/clock.h"
#include "server/meshes/blob_pins.h"
#include "server/store/store.h"

namespace ccst::server {

/// One attribute of a stored mesh.
struct MeshAttributeFacts {
  std::string name;
  int components = 1;
  double min_value = 0.0;
  double max_value = 0.0;
};

/// What is known of a stored mesh without decoding it again.
struct MeshFacts {
  std::int64_t vertices = 0;    ///< After repair.
  std::int64_t file_faces = 0;  ///< Host faces of samples are in [0, file_faces).
  std::int64_t components = 0;
  std::int64_t boundary_loops = 0;
  double area = 0.0;                                     ///< [mesh unit^2]
  Eigen::Vector3d bounds_min = Eigen::Vector3d::Zero();  ///< [mesh unit]
  Eigen::Vector3d bounds_max = Eigen::Vector3d::Zero();
  std::vector<MeshAttributeFacts> attributes;
  std::vector<std::string> warnings;
};

/// A stored mesh as its owner sees it.
struct StoredMesh {
  MeshRecord record;
  MeshFacts facts;
};

/// Limits on what is stored.
struct MeshStoreOptions {
  std::int64_t max_mesh_bytes = std::int64_t{256} << 20;
  std::int64_t max_stored_bytes = std::int64_t{4} << 30;  ///< Of one owner.
  absl::Duration retention = absl::Hours(24 * 7);         ///< Of an unused mesh.
  MeshLimits decode_limits;
};

/// What an upload announces.
struct MeshUpload {
  std::string owner;
  std::string sha256;
  std::int64_t size_bytes = 0;
  std::string display_name;
};

/// How to decode, measure and write down facts; tests put their own in.
struct MeshDependencies {
  /// As DecodeDraco().
  std::function<absl::StatusOr<TriangleMesh>(std::span<const char>, const MeshLimits&)> decode;
  /// Repairs and measures. Errors as SampleSurface() for a mesh that cannot be sampled.
  std::function<absl::StatusOr<MeshFacts>(const TriangleMesh&)> measure;
  std::function<std::string(const MeshFacts&)> encode_facts;
  std::function<absl::StatusOr<MeshFacts>(const std::string&)> decode_facts;
  Clock clock;
};

/// Meshes by digest: quota by owner, expiry, least lately used first out. An owner sees only what
/// it uploaded; equal bytes of two owners are one blob. Calls block on the disk; Finish() decodes.
/// Thread-safe.
class MeshStore {
 public:
  MeshStore(Store& store, BlobPins& pins, const MeshStoreOptions& options,
            MeshDependencies dependencies);

  const MeshStoreOptions& options() const { return options_; }

  /// Which of `sha256s` the owner has not stored; moves the expiry of the others later.
  absl::StatusOr<std::vector<std::string>> FindMissing(const std::string& owner,
                                                       const std::vector<std::string>& sha256s);

  /// A writer for the announced bytes.
  /// @errors INVALID_ARGUMENT LIMIT_EXCEEDED larger than max_mesh_bytes
  ///       | RESOURCE_EXHAUSTED QUOTA_EXCEEDED also after dropping what is idle and least lately
  ///         used cannot make room | those of Store
  absl::StatusOr<std::unique_ptr<BlobWriter>> Begin(const MeshUpload& upload);

  /// Checks digest and size, decodes and measures, and stores. Nothing stays of what is refused.
  /// @errors INVALID_ARGUMENT DIGEST_MISMATCH | those of decode and measure | those of Store
  absl::StatusOr<StoredMesh> Finish(const MeshUpload& upload, BlobWriter& writer);

  /// NOT_FOUND when absent, expired or another owner's.
  absl::StatusOr<StoredMesh> Get(const std::string& owner, const std::string& sha256);
  /// Get(), and moves the expiry later.
  absl::StatusOr<StoredMesh> Use(const std::string& owner, const std::string& sha256);
  absl::StatusOr<std::shared_ptr<const Blob>> Open(const std::string& owner,
                                                   const std::string& sha256);
  /// INVALID_ARGUMENT REQUEST_INVALID for a token that is not one.
  absl::StatusOr<Page<StoredMesh>> List(const std::string& owner, int page_size,
                                        const std::string& page_token);
  /// NOT_FOUND | FAILED_PRECONDITION MESH_IN_USE while a job that has not ended needs it.
  absl::Status Delete(const std::string& owner, const std::string& sha256);

  /// Drops what has expired; called now and then.
  absl::Status DropExpired();

 private:
  absl::Status MakeRoom(const std::string& owner, std::int64_t bytes);
  absl::Status Drop(const MeshRecord& mesh);

  Store& store_;
  BlobPins& pins_;
  const MeshStoreOptions options_;
  const MeshDependencies dependencies_;
};

}  // namespace ccst::server
