#pragma once

#include <map>
#include <string>

#include "absl/status/statusor.h"
#include "server/base/mutex.h"

namespace ccst::server {

/// Uploads that are under way, so that none takes the room of all. Thread-safe.
class UploadSlots {
 public:
  /// One upload; over when it is destroyed.
  class Slot {
   public:
    Slot(UploadSlots& slots, std::string caller) : slots_(&slots), caller_(std::move(caller)) {}
    Slot(Slot&& other) noexcept;
    Slot& operator=(Slot&&) = delete;
    ~Slot();

   private:
    UploadSlots* slots_;  // Null once moved from.
    std::string caller_;
  };

  /// At most `most` at once, of one caller at most `most_of_caller`.
  UploadSlots(int most, int most_of_caller) : most_(most), most_of_caller_(most_of_caller) {}

  /// @errors RESOURCE_EXHAUSTED QUEUE_FULL | QUOTA_EXCEEDED the caller's
  absl::StatusOr<Slot> Take(const std::string& caller);

 private:
  void GiveBack(const std::string& caller);

  const int most_;
  const int most_of_caller_;
  Mutex mutex_;
  int taken_ ABSL_GUARDED_BY(mutex_) = 0;
  std::map<std::string, int> by_caller_ ABSL_GUARDED_BY(mutex_);
};

}  // namespace ccst::server
