#pragma once

#include <string>
#include <string_view>

#include <google/protobuf/message.h>
#include <grpcpp/server_context.h>
#include <grpcpp/support/server_callback.h>

#include "absl/status/status.h"
#include "server/auth/authenticator.h"
#include "server/auth/caller.h"
#include "server/auth/peers.h"
#include "server/base/clock.h"
#include "server/log/server_log.h"
#include "server/metrics/metrics.h"

namespace ccst::server {

/// What every call needs of the server; all outlive it.
struct CallSupport {
  Authenticator& authenticator;
  const Peers& peers;
  ServerLog& log;
  Metrics& metrics;
  const Clock& clock;
};

/// One call from its arrival to its end: who calls and whether they may, what went in and out, how
/// it ended. Leaves one line in the log and one request in the metrics when it goes away. Made
/// first thing in a handler, kept by a reactor until OnDone; ServeUnary() does both for unary
/// calls. Not thread-safe.
class Call {
 public:
  /// Authenticates the caller of `method`, which takes a scope of `needed`.
  Call(const CallSupport& support, const grpc::CallbackServerContext& context,
       std::string_view method, Scope needed);
  ~Call();
  Call(const Call&) = delete;
  Call& operator=(const Call&) = delete;

  /// OK; or UNAUTHENTICATED or PERMISSION_DENIED, and then the call must End() with it, having
  /// done nothing.
  const absl::Status& admission() const { return admission_; }
  /// Who calls; when they are not admitted, what their connection is called.
  const Caller& caller() const { return caller_; }
  /// The caller's W3C trace id, 32 hexadecimal digits; empty when none came.
  const std::string& trace_id() const { return record_.trace_id; }

  /// Counts a message that was received, still whole, and checks that no field is longer than
  /// FieldLimits() allow; INVALID_ARGUMENT REQUEST_INVALID, with which the call must End().
  [[nodiscard]] absl::Status Received(const google::protobuf::Message& message);
  /// Counts a message that is about to be sent, still whole.
  void Sent(const google::protobuf::Message& message);
  /// What the line says besides: the job's name, samples asked for and sent.
  RequestRecord& record() { return record_; }

  /// How the call ends, as gRPC wants it. The last one counts; without one the line says UNKNOWN.
  grpc::Status End(const absl::Status& status);

 private:
  const CallSupport support_;
  const double start_seconds_;
  Caller caller_;
  absl::Status admission_;
  RequestRecord record_;
};

/// Answers a unary call with what `handle(Call&)`, an absl::Status, makes of `response` when the
/// caller is admitted. The line is written before the answer leaves.
template <typename Response, typename Handle>
grpc::ServerUnaryReactor* ServeUnary(const CallSupport& support,
                                     grpc::CallbackServerContext& context, std::string_view method,
                                     Scope needed, const google::protobuf::Message& request,
                                     Response& response, const Handle& handle) {
  grpc::ServerUnaryReactor* reactor = context.DefaultReactor();
  grpc::Status end;
  {
    Call call(support, context, method, needed);
    const absl::Status received = call.Received(request);
    absl::Status status = call.admission();
    status.Update(received);
    if (status.ok()) status = handle(call);
    if (status.ok()) call.Sent(response);
    end = call.End(status);
  }
  reactor->Finish(end);
  return reactor;
}

/// The trace id of a W3C `traceparent` (version-traceid-parentid-flags); empty for a wrong one.
std::string TraceId(std::string_view traceparent);

}  // namespace ccst::server
