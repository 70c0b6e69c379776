#include "server/rpc/upload_slots.h"

#include <utility>

#include "core/base/limit_error.h"
#include "core/base/status.h"

namespace ccst::server {
namespace {

std::string Taken(const std::string& who, int most) {
  return who + std::to_string(most) + " uploads under way, as many as may be; try again later";
}

}  // namespace

UploadSlots::Slot::Slot(Slot&& other) noexcept
    : slots_(std::exchange(other.slots_, nullptr)), caller_(std::move(other.caller_)) {}

UploadSlots::Slot::~Slot() {
  if (slots_ != nullptr) slots_->GiveBack(caller_);
}

absl::StatusOr<UploadSlots::Slot> UploadSlots::Take(const std::string& caller) {
  MutexLock lock(mutex_);
  if (taken_ >= most_) {
    return MakeError(absl::StatusCode::kResourceExhausted, ErrorReason::kQueueFull,
                     Taken("there are ", most_));
  }
  int& own = by_caller_[caller];  // There while it is not 0.
  if (own >= most_of_caller_) {
    if (own == 0) by_caller_.erase(caller);
    return OverQuota({"max_uploads_per_caller", most_of_caller_, most_of_caller_ + 1},
                     Taken("the caller has ", most_of_caller_));
  }
  ++own;
  ++taken_;
  return Slot(*this, caller);
}

void UploadSlots::GiveBack(const std::string& caller) {
  MutexLock lock(mutex_);
  --taken_;
  const auto it = by_caller_.find(caller);
  if (--it->second == 0) by_caller_.erase(it);
}

}  // namespace ccst::server
