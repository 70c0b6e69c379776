#include "core/base/interrupt.h"

#include "absl/strings/str_cat.h"
#include "absl/strings/string_view.h"
#include "core/base/status.h"

namespace ccst {

absl::Status Interrupt::Error(std::string_view activity) const {
  const absl::string_view clause(activity.data(), activity.size());
  if (cause_ != Cause::kTimeLimit) {
    return MakeError(absl::StatusCode::kCancelled, ErrorReason::kCancelled,
                     absl::StrCat("stopped while ", clause));
  }
  return MakeError(absl::StatusCode::kDeadlineExceeded, ErrorReason::kTimeLimitExceeded,
                   absl::StrCat("the time limit passed while ", clause,
                                ", before there was a result to return; allow more time, or ask "
                                "for fewer samples or a smaller mesh"));
}

}  // namespace ccst
