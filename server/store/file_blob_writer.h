#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "core/base/sha256.h"
#include "server/store/blob_folder.h"
#include "server/store/blob_store.h"
#include "server/store/files.h"

namespace ccst::server {

/// Writes one blob of FileBlobs.
class FileBlobWriter : public BlobWriter {
 public:
  /// Starts the file `name` in `incoming`; both folders must outlive the writer.
  static absl::StatusOr<std::unique_ptr<BlobWriter>> Create(BlobFolder& blobs,
                                                            const FileDescriptor& incoming,
                                                            std::string name);
  ~FileBlobWriter() override;

  absl::Status Append(std::string_view bytes) override;
  std::int64_t size_bytes() const override { return size_bytes_; }
  const std::string& Seal() override;
  absl::Status Commit() override;

 private:
  FileBlobWriter(BlobFolder& blobs, const FileDescriptor& incoming, std::string name,
                 FileDescriptor file);
  absl::Status Fail(absl::Status status);
  void Discard();

  BlobFolder& blobs_;
  const FileDescriptor& incoming_;
  const std::string name_;
  FileDescriptor file_;
  std::int64_t size_bytes_ = 0;
  Sha256 hash_;
  std::string sha256_;
  absl::Status status_;
};

}  // namespace ccst::server
