#include "server/rpc/stream_memory.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/limit_error.h"
#include "core/base/status.h"

namespace ccst::server {

StreamMemory::Share::Share(Share&& other) noexcept
    : memory_(std::exchange(other.memory_, nullptr)),
      caller_(std::move(other.caller_)),
      bytes_(other.bytes_) {}

StreamMemory::Share::~Share() {
  if (memory_ != nullptr) memory_->GiveBack(caller_, bytes_);
}

absl::StatusOr<StreamMemory::Share> StreamMemory::Take(const std::string& caller,
                                                       std::int64_t bytes) {
  MutexLock lock(mutex_);
  const auto found = by_caller_.find(caller);
  const std::int64_t own = (found == by_caller_.end() ? 0 : found->second) + bytes;
  if (own > limits_.most_bytes_of_caller()) {
    return OverQuota({"max_stream_bytes_per_caller", limits_.most_bytes_of_caller(), own},
                     absl::StrCat("the caller's open streams would keep ", own,
                                  " bytes of messages, of at most ", limits_.most_bytes_of_caller(),
                                  "; end some first"));
  }
  if (taken_ + bytes > limits_.most_bytes) {
    absl::Status full = MakeError(
        absl::StatusCode::kResourceExhausted, ErrorReason::kQueueFull,
        absl::StrCat("the open streams of all callers would keep ", taken_ + bytes,
                     " bytes of messages, of at most ", limits_.most_bytes, "; try again later"));
    SetPassedLimit({"max_stream_bytes", limits_.most_bytes, taken_ + bytes}, full);
    return full;
  }
  by_caller_[caller] = own;
  taken_ += bytes;
  return Share(*this, caller, bytes);
}

void StreamMemory::GiveBack(const std::string& caller, std::int64_t bytes) {
  MutexLock lock(mutex_);
  taken_ -= bytes;
  const auto it = by_caller_.find(caller);
  it->second -= bytes;
  if (it->second == 0) by_caller_.erase(it);
}

}  // namespace ccst::server
