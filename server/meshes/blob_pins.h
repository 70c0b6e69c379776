#pragma once

#include <map>
#include <string>

#include "absl/status/status.h"
#include "server/base/mutex.h"
#include "server/store/store.h"

namespace ccst::server {

/// Keeps blobs alive between the moment they are found or written and the moment a record refers
/// to them, and removes those that nothing refers to any more. Thread-safe.
class BlobPins {
 public:
  /// One held pin.
  class Pin {
   public:
    Pin(BlobPins& pins, std::string sha256);
    ~Pin();
    Pin(const Pin&) = delete;
    Pin& operator=(const Pin&) = delete;

   private:
    BlobPins& pins_;
    const std::string sha256_;
  };

  explicit BlobPins(Store& store) : store_(store) {}

  /// A record that referred to the blob is gone: removes the blob when no other does, once the
  /// last pin is gone. Errors as Store.
  absl::Status Drop(const std::string& sha256);

 private:
  struct Count {
    int pins = 0;
    bool dropped = false;
  };

  void Release(const std::string& sha256);
  absl::Status RemoveIfUnreferenced(const std::string& sha256)
      ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);

  Store& store_;
  Mutex mutex_;
  std::map<std::string, Count> counts_ ABSL_GUARDED_BY(mutex_);
};

}  // namespace ccst::server
