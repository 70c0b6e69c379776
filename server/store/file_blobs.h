#pragma once

#include <atomic>
#include <memory>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "server/store/blob_space.h"
#include "server/store/blob_store.h"
#include "server/store/files.h"

namespace ccst::server {

/// Blobs as files `blobs/ab/abcdef...`, by the first digits of the digest. One on its way is a file
/// in `incoming` and gets its place by a rename, so that whatever is in `blobs` is whole.
class FileBlobs : public BlobStore {
 public:
  /// The blobs below `directory`, which nobody else writes to; drops what was on its way when the
  /// process before this one went away.
  /// @errors RESOURCE_EXHAUSTED STORAGE_FULL | INTERNAL STORAGE_FAILED
  static absl::StatusOr<std::unique_ptr<FileBlobs>> Open(const FileDescriptor& directory,
                                                         std::int64_t max_bytes);

  absl::StatusOr<std::unique_ptr<BlobWriter>> NewBlob() override;
  absl::StatusOr<std::shared_ptr<const Blob>> Open(const std::string& sha256) const override;
  absl::Status CheckRoom(std::int64_t bytes) const override { return space_.Check(bytes); }
  bool Contains(const std::string& sha256) const override;
  absl::Status Remove(const std::string& sha256) override;
  absl::StatusOr<std::vector<std::string>> List() const override;

 private:
  FileBlobs(FileDescriptor blobs, FileDescriptor incoming, std::int64_t max_bytes)
      : blobs_(std::move(blobs)), incoming_(std::move(incoming)), space_(max_bytes) {}
  // 0 when it is not there.
  std::int64_t SizeOf(const std::string& sha256) const;

  const FileDescriptor blobs_;
  const FileDescriptor incoming_;
  std::atomic<std::uint64_t> next_name_ = 0;
  BlobSpace space_;
};

}  // namespace ccst::server
