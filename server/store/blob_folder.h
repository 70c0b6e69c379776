#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "absl/status/status.h"
#include "server/base/mutex.h"
#include "server/store/blob_space.h"
#include "server/store/files.h"
#include "server/store/known_blobs.h"
#include "server/store/space_reserve.h"

namespace ccst::server {

/// The blobs in their places, and the space that all blobs take. What is in a place and what is
/// counted change together, so that the space is that of the files whoever puts and removes the
/// same blob at once. Thread-safe.
class BlobFolder {
 public:
  /// Nothing is counted yet. `reserve` outlives it; null: there is none.
  BlobFolder(FileDescriptor directory, std::int64_t max_bytes, SpaceReserve* reserve)
      : directory_(std::move(directory)), space_(max_bytes), reserve_(reserve) {}

  const FileDescriptor& directory() const { return directory_; }

  /// RESOURCE_EXHAUSTED STORAGE_FULL when `bytes` more are over the limit or more than the disk
  /// has.
  absl::Status CheckRoom(std::int64_t bytes) const;
  /// Counts `bytes` that are about to be written.
  /// @errors RESOURCE_EXHAUSTED STORAGE_FULL over the limit, or no room but for deleting
  absl::Status Take(std::int64_t bytes);
  /// Counts what is there already, whatever the limit is now.
  void Count(std::int64_t bytes) { space_.Count(bytes); }
  /// What was counted will not be there.
  void GiveBack(std::int64_t bytes) { space_.GiveBack(bytes); }
  std::int64_t used_bytes() const { return space_.used_bytes(); }
  /// Outlives this with those who still read.
  const std::shared_ptr<KnownBlobs>& known() const { return known_; }

  /// Where the blob of a digest is below directory().
  static std::string PathOf(const std::string& sha256);

  bool Contains(const std::string& sha256) const;
  /// 0 when it is not there.
  std::int64_t SizeOf(const std::string& sha256) const;

  /// Renames `name` in `incoming`, whose bytes are counted already, to the place of `sha256`. What
  /// it replaces is given back. It lasts once SynchronizePlace() returned.
  /// @errors RESOURCE_EXHAUSTED STORAGE_FULL | INTERNAL STORAGE_FAILED; nothing was changed then
  absl::Status Place(const FileDescriptor& incoming, const std::string& name,
                     const std::string& sha256);
  /// Errors as Place(); the blob is in its place nevertheless.
  absl::Status SynchronizePlace(const std::string& sha256) const;

  /// Nothing happens when it is not there. Errors as Place().
  absl::Status Remove(const std::string& sha256);

 private:
  const FileDescriptor directory_;
  BlobSpace space_;
  SpaceReserve* const reserve_;
  const std::shared_ptr<KnownBlobs> known_ = std::make_shared<KnownBlobs>();
  // Held from looking at a place until it is changed and counted.
  Mutex places_;
};

}  // namespace ccst::server
