#pragma once

#include <grpcpp/support/status.h>

#include "absl/status/status.h"

namespace ccst::server {

/// The one way an error leaves the server: code, message and, in `grpc-status-details-bin`, a
/// ccst.v1.Status with an `ErrorInfo`, the details of `status`, and a `RetryAdvice` where trying
/// again later may help.
grpc::Status ToGrpcStatus(const absl::Status& status);

}  // namespace ccst::server
