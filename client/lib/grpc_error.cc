#include "client/lib/grpc_error.h"

#include "absl/strings/str_cat.h"
#include "ccst/v1/error.pb.h"
#include "proto/convert/scalars.h"
#include "proto/convert/status.h"

namespace ccst {
namespace {

bool BreaksConnection(grpc::StatusCode code) {
  return code == grpc::StatusCode::UNAVAILABLE || code == grpc::StatusCode::UNKNOWN ||
         code == grpc::StatusCode::INTERNAL;
}

}  // namespace

absl::Status FromGrpcStatus(const grpc::Status& status, CallStage stage) {
  if (status.ok()) return absl::OkStatus();
  v1::Status details;
  if (details.ParseFromString(status.error_details()) &&
      details.code() == static_cast<int>(status.error_code())) {
    return FromProto(details);
  }
  if (stage == CallStage::kStreaming && BreaksConnection(status.error_code())) {
    return absl::UnavailableError(
        absl::StrCat("the connection to the server was lost: ", status.error_message()));
  }
  return absl::Status(static_cast<absl::StatusCode>(status.error_code()), status.error_message());
}

std::optional<double> RetryDelaySeconds(const absl::Status& status) {
  v1::RetryAdvice advice;
  if (!GetDetail(status, advice)) return std::nullopt;
  return SecondsFromProto(advice.retry_delay());
}

}  // namespace ccst
