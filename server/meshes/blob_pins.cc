#include "server/meshes/blob_pins.h"

#include <utility>

#include "core/base/status.h"

namespace ccst::server {

BlobPins::Pin::Pin(BlobPins& pins, std::string sha256) : pins_(pins), sha256_(std::move(sha256)) {
  MutexLock lock(pins_.mutex_);
  ++pins_.counts_[sha256_].pins;
}

BlobPins::Pin::~Pin() { pins_.Release(sha256_); }

absl::Status BlobPins::Drop(const std::string& sha256) {
  if (sha256.empty()) return absl::OkStatus();
  MutexLock lock(mutex_);
  if (const auto it = counts_.find(sha256); it != counts_.end()) {
    it->second.dropped = true;
    return absl::OkStatus();
  }
  return RemoveIfUnreferenced(sha256);
}

void BlobPins::Release(const std::string& sha256) {
  MutexLock lock(mutex_);
  const auto it = counts_.find(sha256);
  if (--it->second.pins > 0) return;
  const bool dropped = it->second.dropped;
  counts_.erase(it);
  // What cannot be removed now goes when the store is opened next.
  if (dropped) RemoveIfUnreferenced(sha256).IgnoreError();
}

absl::Status BlobPins::RemoveIfUnreferenced(const std::string& sha256) {
  bool referenced = false;
  CCST_ASSIGN_OR_RETURN(referenced, store_.IsReferenced(sha256));
  return referenced ? absl::OkStatus() : store_.blobs().Remove(sha256);
}

}  // namespace ccst::server
