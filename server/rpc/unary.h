#pragma once

#include <memory>
#include <optional>
#include <stop_token>
#include <string_view>
#include <utility>

#include <google/protobuf/message.h>
#include <grpcpp/server_context.h>
#include <grpcpp/support/server_callback.h>

#include "absl/status/status.h"
#include "server/base/executor.h"
#include "server/rpc/call.h"
#include "server/rpc/rpc_executor.h"

namespace ccst::server {

/// Ends `reactor`, that of a unary call, with what `handle(Call&)` says on `executor`, or with
/// QUEUE_FULL when that refuses. What ServeUnaryOn() and ServeStoppableOn() have in common.
template <typename Response, typename Handle>
void FinishOn(Executor& executor, grpc::ServerUnaryReactor* reactor, const CallSupport& support,
              const grpc::CallbackServerContext& context, std::string_view method, Scope needed,
              const google::protobuf::Message& request, Response& response, Handle handle) {
  const auto call = std::make_shared<std::optional<Call>>();
  call->emplace(support, context, method, needed);
  const absl::Status received = (*call)->Received(request);
  // Leaves the call's line before the answer.
  const auto finish = [reactor, call](const absl::Status& status) {
    const grpc::Status end = (*call)->End(status);
    call->reset();
    reactor->Finish(end);
  };
  absl::Status admitted = (*call)->admission();
  admitted.Update(received);
  if (!admitted.ok()) {
    finish(admitted);
    return;
  }
  const bool accepted =
      executor.Run([call, finish, &response, handle = std::move(handle)]() mutable {
        const absl::Status status = RunStep([&] { return handle(**call); });
        if (status.ok()) (*call)->Sent(response);
        finish(status);
      });
  if (!accepted) finish(ExecutorFull());
}

/// As ServeUnary(), with `handle` run on `executor`: for what may block or take long. Ends with
/// QUEUE_FULL when the executor refuses. A caller that goes away changes nothing: `handle` runs to
/// its end, and its answer is dropped. `request` and `response` live until then; `handle` is moved
/// along and may be called once.
template <typename Response, typename Handle>
grpc::ServerUnaryReactor* ServeUnaryOn(Executor& executor, const CallSupport& support,
                                       grpc::CallbackServerContext& context,
                                       std::string_view method, Scope needed,
                                       const google::protobuf::Message& request, Response& response,
                                       Handle handle) {
  grpc::ServerUnaryReactor* reactor = context.DefaultReactor();
  FinishOn(executor, reactor, support, context, method, needed, request, response,
           std::move(handle));
  return reactor;
}

/// One unary call that asks its work to stop when the caller goes away or its deadline passes.
class StoppableReactor final : public grpc::ServerUnaryReactor {
 public:
  std::stop_token stop_token() const { return stop_.get_token(); }

  void OnCancel() override { stop_.request_stop(); }
  void OnDone() override { delete this; }

 private:
  ~StoppableReactor() override = default;

  std::stop_source stop_;
};

/// As ServeUnaryOn(), for work that takes seconds: `handle(Call&, const std::stop_token&)` should
/// end, with CANCELLED, soon after the stop.
template <typename Response, typename Handle>
grpc::ServerUnaryReactor* ServeStoppableOn(Executor& executor, const CallSupport& support,
                                           grpc::CallbackServerContext& context,
                                           std::string_view method, Scope needed,
                                           const google::protobuf::Message& request,
                                           Response& response, Handle handle) {
  auto* reactor = new StoppableReactor;  // Until OnDone().
  FinishOn(executor, reactor, support, context, method, needed, request, response,
           [stop = reactor->stop_token(), handle = std::move(handle)](Call& call) mutable {
             return handle(call, stop);
           });
  return reactor;
}

}  // namespace ccst::server
