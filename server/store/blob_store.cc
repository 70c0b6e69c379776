#include "server/store/blob_store.h"

#include "core/base/sha256.h"
#include "core/base/status.h"

namespace ccst::server {

absl::StatusOr<std::string> ReadWhole(const BlobStore& blobs, const std::string& sha256) {
  std::shared_ptr<const Blob> blob;
  CCST_ASSIGN_OR_RETURN(blob, blobs.Open(sha256));
  std::string bytes(static_cast<std::size_t>(blob->size_bytes()), '\0');
  CCST_RETURN_IF_ERROR(blob->Read(0, bytes));
  if (Sha256Of(bytes) != sha256) {
    return MakeError(absl::StatusCode::kInternal, ErrorReason::kStorageFailed,
                     "the stored bytes of " + sha256 + " are damaged");
  }
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
