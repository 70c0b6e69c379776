#pragma once

#include <optional>

#include <grpcpp/support/status.h>

#include "absl/status/status.h"

namespace ccst {

/// How far a call had come when it ended.
enum class CallStage {
  kBeforeFirstMessage,
  kStreaming,
};

/// The error a call ended with: reason and details where the server sent them, else gRPC's code
/// and message. A stream that breaks off without details is UNAVAILABLE whatever the code: a
/// server that dies is UNAVAILABLE directly, UNKNOWN or INTERNAL behind a proxy.
absl::Status FromGrpcStatus(const grpc::Status& status, CallStage stage);

/// Seconds after which the server advises to try again; empty without advice.
std::optional<double> RetryDelaySeconds(const absl::Status& status);

}  // namespace ccst
