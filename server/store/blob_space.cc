#include "server/store/blob_space.h"

#include "absl/strings/str_cat.h"
#include "core/base/limit_error.h"
#include "core/base/status.h"

namespace ccst::server {

absl::Status BlobSpace::Check(std::int64_t bytes) const {
  MutexLock lock(mutex_);
  return CheckLocked(bytes);
}

absl::Status BlobSpace::Take(std::int64_t bytes) {
  MutexLock lock(mutex_);
  absl::Status status = CheckLocked(bytes);
  if (status.ok()) used_bytes_ += bytes;
  return status;
}

void BlobSpace::Count(std::int64_t bytes) {
  MutexLock lock(mutex_);
  used_bytes_ += bytes;
}

std::int64_t BlobSpace::used_bytes() const {
  MutexLock lock(mutex_);
  return used_bytes_;
}

absl::Status BlobSpace::CheckLocked(std::int64_t bytes) const {
  if (bytes <= limit_bytes_ - used_bytes_) return absl::OkStatus();
  if (bytes > limit_bytes_) {
    return OverLimit({"max_data_bytes", limit_bytes_, bytes},
                     absl::StrCat(bytes, " bytes are to be kept; the server keeps at most ",
                                  limit_bytes_, " bytes of meshes, images and samples"));
  }
  return MakeError(
      absl::StatusCode::kResourceExhausted, ErrorReason::kStorageFull,
      absl::StrCat("the server keeps ", used_bytes_, " bytes of meshes and samples, of ",
                   "at most ", limit_bytes_, ", and ", bytes,
                   " more do not fit; delete jobs or meshes, or wait until some expire"));
}

}  // namespace ccst::server
