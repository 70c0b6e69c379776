#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "core/io/byte_source.h"
#include "core/io/mesh_limits.h"
#include "core/mesh/triangle_mesh.h"
#include "server/base/clock.h"
#include "server/base/mutex.h"
#include "server/formats/mesh_facts.h"
#include "server/meshes/blob_pins.h"
#include "server/store/record_bytes.h"
#include "server/store/store.h"

namespace ccst::server {

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
  RecordLimits records;
};

/// Names the bytes of a mesh.
struct MeshDigest {
  std::string sha256;
  std::int64_t size_bytes = 0;
};

/// What an upload announces.
struct MeshUpload {
  std::string owner;
  std::string sha256;
  std::int64_t size_bytes = 0;
  std::string display_name;
};

/// How to decode and measure; tests put their own in.
struct MeshDependencies {
  /// As DecodeDraco().
  std::function<absl::StatusOr<TriangleMesh>(std::span<const char>, const MeshLimits&)> decode;
  /// Memory for reading, decoding and measuring these bytes, in use while what it returns exists.
  /// Null: there is no bound. RESOURCE_EXHAUSTED when there is none for too long.
  std::function<absl::StatusOr<std::shared_ptr<void>>(const ByteSource&)> take_memory;
  /// Repairs and measures. Errors as SampleSurface() for a mesh that cannot be sampled.
  std::function<absl::StatusOr<MeshFacts>(const TriangleMesh&)> measure;
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

  /// Which of `digests` the owner has not stored, or only damaged; moves the expiry of the others
  /// later where `is_use`, in one step for all of them. Reads the bytes of those that were not
  /// found right since they were written.
  absl::StatusOr<std::vector<MeshDigest>> FindMissing(const std::string& owner,
                                                      const std::vector<MeshDigest>& digests,
                                                      bool is_use = true);

  /// A writer for the announced bytes. Drops nothing yet: the upload may break.
  /// @errors INVALID_ARGUMENT LIMIT_EXCEEDED larger than max_mesh_bytes, or than all meshes of a
  ///         caller or all that is stored may be together
  ///       | RESOURCE_EXHAUSTED QUOTA_EXCEEDED when dropping all that is idle would not make room,
  ///         or the owner has too many records | those of Store
  absl::StatusOr<std::unique_ptr<BlobWriter>> Begin(const MeshUpload& upload);

  /// Checks digest and size, decodes and measures, drops of what is idle the least lately used
  /// until there is room, and stores. A mesh that was stored meanwhile stays as it is; one that is
  /// damaged is healed. Nothing stays of what is refused. Holds the encoded and the decoded mesh in
  /// memory.
  /// @errors INVALID_ARGUMENT DIGEST_MISMATCH | RESOURCE_EXHAUSTED QUOTA_EXCEEDED | those of
  ///         take_memory, decode and measure | those of Store
  absl::StatusOr<StoredMesh> Finish(const MeshUpload& upload, BlobWriter& writer);

  /// NOT_FOUND when absent, expired or another owner's.
  absl::StatusOr<StoredMesh> Get(const std::string& owner, const std::string& sha256);
  /// Get(), and moves the expiry later. Reads the bytes unless they were found right since they
  /// were written.
  /// @errors NOT_FOUND | DATA_LOSS STORAGE_FAILED what is stored of it is damaged or gone
  absl::StatusOr<StoredMesh> Use(const std::string& owner, const std::string& sha256);
  /// The bytes, unchecked but for their number, see OpenPinned(). Changes nothing.
  /// @errors NOT_FOUND | DATA_LOSS STORAGE_FAILED they are damaged or gone
  absl::StatusOr<std::shared_ptr<const Blob>> Open(const std::string& owner,
                                                   const std::string& sha256);
  /// INVALID_ARGUMENT REQUEST_INVALID for a token that is not one.
  absl::StatusOr<Page<StoredMesh>> List(const std::string& owner, int page_size,
                                        const std::string& page_token);
  /// NOT_FOUND | FAILED_PRECONDITION MESH_IN_USE while a job that has not ended needs it.
  absl::Status Delete(const std::string& owner, const std::string& sha256);

  /// Drops what has expired, going on where one cannot be; called now and then. The first error.
  absl::Status DropExpired();

 private:
  // As records keep it.
  absl::Time Now() const;
  // Empty when absent or expired.
  absl::StatusOr<std::optional<MeshRecord>> Find(const std::string& owner,
                                                 const std::string& sha256);
  // Find(), and moves the expiry later where the disk takes that.
  absl::StatusOr<std::optional<MeshRecord>> Touch(const std::string& owner,
                                                  const std::string& sha256)
      ABSL_EXCLUSIVE_LOCKS_REQUIRED(changes_);
  // Of an upload that is whole just now.
  MeshRecord RecordOf(const MeshUpload& upload, std::string facts) const;
  // False for a record that is damaged.
  bool IsReadable(const MeshRecord& record) const;
  // DATA_LOSS when the record or the bytes are damaged or gone.
  absl::Status CheckWhole(const MeshRecord& record) const;
  // What a damaged record says of the mesh is left out, and a warning says so.
  StoredMesh WithFacts(MeshRecord record) const;
  // The facts of a stored blob, as bytes.
  absl::StatusOr<std::string> Measure(const std::string& sha256) const;
  // What to drop, least lately used first, so that `bytes` more fit; QUOTA_EXCEEDED when all that
  // is idle would not do, LIMIT_EXCEEDED when nothing would.
  absl::StatusOr<std::vector<MeshRecord>> InTheWayOf(const std::string& owner, std::int64_t bytes);
  absl::Status Drop(const MeshRecord& mesh) ABSL_EXCLUSIVE_LOCKS_REQUIRED(changes_);

  Store& store_;
  BlobPins& pins_;
  const MeshStoreOptions options_;
  const MeshDependencies dependencies_;
  // One change at a time: between looking at a record and acting on it, nobody else may.
  Mutex changes_;
};

}  // namespace ccst::server
