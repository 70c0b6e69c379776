#pragma once

#include <atomic>
#include <memory>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "server/store/blob_folder.h"
#include "server/store/blob_store.h"
#include "server/store/files.h"

namespace ccst::server {

class FileBlob;

/// Blobs as files `blobs/ab/abcdef...`, by the first digits of the digest. One on its way is a file
/// in `incoming` and gets its place by a rename, so that whatever is in `blobs` is whole.
class FileBlobs : public BlobStore {
 public:
  /// The blobs below `directory`, which nobody else writes to; drops what was on its way when the
  /// process before this one went away. While `reserve` is not whole, nothing is written; it
  /// outlives the blobs, and is null where there is none.
  /// @errors RESOURCE_EXHAUSTED STORAGE_FULL | INTERNAL STORAGE_FAILED
  static absl::StatusOr<std::unique_ptr<FileBlobs>> Open(const FileDescriptor& directory,
                                                         std::int64_t max_bytes,
                                                         SpaceReserve* reserve = nullptr);

  absl::StatusOr<std::unique_ptr<BlobWriter>> NewBlob() override;
  absl::StatusOr<std::shared_ptr<const Blob>> Open(const std::string& sha256) const override;
  absl::Status CheckRoom(std::int64_t bytes) const override { return blobs_.CheckRoom(bytes); }
  std::int64_t used_bytes() const override { return blobs_.used_bytes(); }
  bool Contains(const std::string& sha256) const override { return blobs_.Contains(sha256); }
  absl::Status Check(const std::string& sha256) const override;
  absl::Status Remove(const std::string& sha256) override { return blobs_.Remove(sha256); }
  absl::StatusOr<std::vector<std::string>> List() const override;

 private:
  FileBlobs(FileDescriptor blobs, FileDescriptor incoming, std::int64_t max_bytes,
            SpaceReserve* reserve)
      : blobs_(std::move(blobs), max_bytes, reserve), incoming_(std::move(incoming)) {}
  absl::StatusOr<std::shared_ptr<const FileBlob>> OpenFile(const std::string& sha256) const;

  BlobFolder blobs_;
  const FileDescriptor incoming_;
  std::atomic<std::uint64_t> next_name_ = 0;
};

}  // namespace ccst::server
