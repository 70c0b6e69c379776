#pragma once

#include <chrono>
#include <stop_token>

#include <grpcpp/client_context.h>
#include <grpcpp/support/status.h>

#include "absl/status/statusor.h"
#include "client/lib/grpc_error.h"
#include "client/lib/retry.h"
#include "core/base/status.h"

namespace ccst {

/// Makes a call that may be repeated without harm, again when the server was not reached or the
/// connection was lost.
/// @param call  (grpc::ClientContext&, Response&) -> grpc::Status
/// @errors what the server answered | UNAVAILABLE | DEADLINE_EXCEEDED | CANCELLED `stop`
template <typename Response, typename Call>
absl::StatusOr<Response> RepeatableCall(const std::stop_token& stop, const Call& call) {
  constexpr std::chrono::seconds kTimeout{30};
  Retry retry(stop);
  for (;;) {
    if (stop.stop_requested()) return StoppedError();
    grpc::ClientContext context;
    context.set_deadline(std::chrono::system_clock::now() + kTimeout);
    const std::stop_callback cancel(stop, [&context] { context.TryCancel(); });
    Response response;
    const grpc::Status status = call(context, response);
    if (status.ok()) return response;
    CCST_RETURN_IF_ERROR(retry.Wait(FromGrpcStatus(status, CallStage::kStreaming)));
  }
}

}  // namespace ccst
