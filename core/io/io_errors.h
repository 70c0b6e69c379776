#pragma once

#include <string>

#include "absl/status/status.h"
#include "absl/strings/string_view.h"
#include "core/base/status.h"

namespace ccst::io {

// The refusals of this room, all INVALID_ARGUMENT with a reason.

inline absl::Status Unreadable(const std::string& message) {
  return MakeError(absl::StatusCode::kInvalidArgument, ErrorReason::kMeshUnreadable, message);
}

inline absl::Status Degenerate(const std::string& message) {
  return MakeError(absl::StatusCode::kInvalidArgument, ErrorReason::kMeshDegenerate, message);
}

inline absl::Status Empty(const std::string& message) {
  return MakeError(absl::StatusCode::kInvalidArgument, ErrorReason::kMeshEmpty, message);
}

inline absl::Status OverLimit(const std::string& message) {
  return MakeError(absl::StatusCode::kInvalidArgument, ErrorReason::kLimitExceeded, message);
}

inline absl::Status NotDraco(const std::string& message) {
  return MakeError(absl::StatusCode::kInvalidArgument, ErrorReason::kDracoDecodeFailed, message);
}

/// `status` with `prefix` in front of its message; code and payloads stay.
absl::Status WithPrefix(const absl::Status& status, const std::string& prefix);

}  // namespace ccst::io
