#include "client/cli/exit_code.h"

#include "core/base/status.h"

namespace ccst::cli {

ExitCode ExitCodeFor(const absl::Status& status) {
  switch (status.code()) {
    case absl::StatusCode::kOk:
      return kOk;
    case absl::StatusCode::kCancelled:
      return kCancelled;
    case absl::StatusCode::kUnavailable:
      return kUnreachable;
    case absl::StatusCode::kDeadlineExceeded:
      // Of the job's time limit, or of a call that nobody answered.
      return GetErrorReason(status) == ErrorReason::kTimeLimitExceeded ? kFailed : kUnreachable;
    case absl::StatusCode::kResourceExhausted:
      // A full queue and a message over the transport's limit are refusals.
      return GetErrorReason(status) == ErrorReason::kOutOfMemory ? kFailed : kRefused;
    case absl::StatusCode::kInvalidArgument:
    case absl::StatusCode::kFailedPrecondition:
    case absl::StatusCode::kOutOfRange:
    case absl::StatusCode::kNotFound:
    case absl::StatusCode::kPermissionDenied:
    case absl::StatusCode::kUnauthenticated:
    case absl::StatusCode::kUnimplemented:
    case absl::StatusCode::kAlreadyExists:
      return kRefused;
    case absl::StatusCode::kInternal:
    case absl::StatusCode::kUnknown:
    case absl::StatusCode::kAborted:
    case absl::StatusCode::kDataLoss:
    default:
      return kFailed;
  }
}

}  // namespace ccst::cli
