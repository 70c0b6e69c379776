#include "server/rpc/grpc_status.h"

#include <optional>

#include "ccst/v1/error.pb.h"
#include "core/base/status.h"
#include "proto/convert/scalars.h"
#include "proto/convert/status.h"

namespace ccst::server {
namespace {

// A place in a full queue comes free when a run ends; another server is there at once.
constexpr double kQueueFullRetrySeconds = 2.0;
constexpr double kDrainingRetrySeconds = 1.0;
// Room comes back when jobs end, or somebody deletes something.
constexpr double kNoRoomRetrySeconds = 30.0;

std::optional<double> RetrySeconds(const absl::Status& status) {
  const auto reason = GetErrorReason(status);
  if (reason == ErrorReason::kQueueFull) return kQueueFullRetrySeconds;
  if (reason == ErrorReason::kDraining) return kDrainingRetrySeconds;
  if (reason == ErrorReason::kQuotaExceeded || reason == ErrorReason::kStorageFull) {
    return kNoRoomRetrySeconds;
  }
  return std::nullopt;
}

}  // namespace

grpc::Status ToGrpcStatus(const absl::Status& status) {
  if (status.ok()) return grpc::Status::OK;
  absl::Status detailed = status;
  if (const auto seconds = RetrySeconds(status)) {
    v1::RetryAdvice advice;
    *advice.mutable_retry_delay() = DurationToProto(*seconds);
    SetDetail(advice, detailed);
  }
  const v1::Status message = ToProto(detailed);
  return grpc::Status(static_cast<grpc::StatusCode>(message.code()), message.message(),
                      message.SerializeAsString());
}

}  // namespace ccst::server
