#include "server/store/blob_store.h"

#include <utility>

#include "core/base/status.h"

namespace ccst::server {

CheckedReader::CheckedReader(std::shared_ptr<const Blob> blob, std::string sha256)
    : blob_(std::move(blob)), sha256_(std::move(sha256)) {}

absl::Status CheckedReader::Next(std::span<char> out) {
  CCST_RETURN_IF_ERROR(blob_->Read(offset_, out));
  hash_.Add({out.data(), out.size()});
  offset_ += static_cast<std::int64_t>(out.size());
  if (!at_end() || hash_.Finish() == sha256_) return absl::OkStatus();
  blob_->Doubt();
  return DamagedBlob(sha256_);
}

absl::Status DamagedBlob(const std::string& sha256) {
  return MakeError(absl::StatusCode::kDataLoss, ErrorReason::kStorageFailed,
                   "the stored bytes of " + sha256 + " are damaged; send them again");
}

absl::StatusOr<std::string> ReadWhole(const BlobStore& blobs, const std::string& sha256) {
  std::shared_ptr<const Blob> blob;
  CCST_ASSIGN_OR_RETURN(blob, blobs.Open(sha256));
  std::string bytes(static_cast<std::size_t>(blob->size_bytes()), '\0');
  CCST_RETURN_IF_ERROR(CheckedReader(blob, sha256).Next(bytes));
  return bytes;
}

absl::StatusOr<std::string> PutWhole(BlobStore& blobs, std::string_view bytes) {
  std::unique_ptr<BlobWriter> writer;
  CCST_ASSIGN_OR_RETURN(writer, blobs.NewBlob());
  CCST_RETURN_IF_ERROR(writer->Append(bytes));
  std::string sha256 = writer->Seal();
  CCST_RETURN_IF_ERROR(writer->Commit());
  return sha256;
}

}  // namespace ccst::server
