#pragma once

#include <memory>
#include <optional>
#include <string_view>
#include <utility>

#include <google/protobuf/message_lite.h>
#include <grpcpp/server_context.h>
#include <grpcpp/support/server_callback.h>

#include "absl/status/status.h"
#include "server/base/executor.h"
#include "server/rpc/call.h"
#include "server/rpc/rpc_executor.h"

namespace ccst::server {

/// As ServeUnary(), with `handle` run on `executor`: for what may block or take long. Ends with
/// QUEUE_FULL when the executor refuses. A caller that goes away changes nothing: `handle` runs to
/// its end, and its answer is dropped. `request` and `response` live until then; `handle` is moved
/// along and may be called once.
template <typename Response, typename Handle>
grpc::ServerUnaryReactor* ServeUnaryOn(Executor& executor, const CallSupport& support,
                                       grpc::CallbackServerContext& context,
                                       std::string_view method, Scope needed,
                                       const google::protobuf::MessageLite& request,
                                       Response& response, Handle handle) {
  grpc::ServerUnaryReactor* reactor = context.DefaultReactor();
  const auto call = std::make_shared<std::optional<Call>>();
  call->emplace(support, context, method, needed);
  (*call)->Received(request);
  // Leaves the call's line before the answer.
  const auto finish = [reactor, call](const absl::Status& status) {
    const grpc::Status end = (*call)->End(status);
    call->reset();
    reactor->Finish(end);
  };
  if (!(*call)->admission().ok()) {
    finish((*call)->admission());
    return reactor;
  }
  const bool accepted =
      executor.Run([call, finish, &response, handle = std::move(handle)]() mutable {
        const absl::Status status = RunStep([&] { return handle(**call); });
        if (status.ok()) (*call)->Sent(response);
        finish(status);
      });
  if (!accepted) finish(ExecutorFull());
  return reactor;
}

}  // namespace ccst::server
