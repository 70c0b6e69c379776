#pragma once

#include <cstdint>

#include "absl/status/status.h"
#include "server/base/mutex.h"

namespace ccst::server {

/// The bytes that all blobs have, those on their way included, and how many they may have.
/// Thread-safe.
class BlobSpace {
 public:
  explicit BlobSpace(std::int64_t limit_bytes) : limit_bytes_(limit_bytes) {}

  /// RESOURCE_EXHAUSTED STORAGE_FULL when `bytes` more are over the limit; INVALID_ARGUMENT
  /// LIMIT_EXCEEDED when they alone are.
  absl::Status Check(std::int64_t bytes) const;
  /// The same, and takes them.
  absl::Status Take(std::int64_t bytes);
  /// Takes what is there already, whatever the limit is now.
  void Count(std::int64_t bytes);
  void GiveBack(std::int64_t bytes) { Count(-bytes); }
  std::int64_t used_bytes() const;

 private:
  absl::Status CheckLocked(std::int64_t bytes) const ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);

  const std::int64_t limit_bytes_;
  mutable Mutex mutex_;
  std::int64_t used_bytes_ ABSL_GUARDED_BY(mutex_) = 0;
};

}  // namespace ccst::server
