#include "client/lib/client.h"

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <utility>

#include <grpcpp/client_context.h>

#include "client/lib/answer.h"
#include "client/lib/grpc_error.h"
#include "core/base/status.h"
#include "proto/convert/options.h"
#include "proto/convert/scalars.h"

namespace ccst {
namespace {

constexpr int kAttempts = 3;
constexpr double kFirstRetrySeconds = 0.2;  // Doubled for each further attempt.
constexpr double kMaxRetrySeconds = 5.0;
constexpr std::chrono::seconds kInfoTimeout{10};

absl::Status Cancelled() {
  return MakeError(absl::StatusCode::kCancelled, ErrorReason::kCancelled, "cancelled");
}

v1::SampleRequest ToRequest(const SampleJob& job) {
  v1::SampleRequest request;
  v1::InlineMesh& mesh = *request.mutable_inline_mesh();
  mesh.set_format(v1::MESH_FORMAT_DRACO);
  mesh.set_data(job.draco);
  if (!job.origin.isZero(0.0)) *mesh.mutable_origin() = ToProto(job.origin);
  *request.mutable_options() = ToProto(job.options);
  request.set_preview_sample_count(job.preview_sample_count);
  return request;
}

absl::StatusOr<SampleOutcome> Attempt(v1::SamplingService::StubInterface& stub,
                                      const v1::SampleRequest& request, const SampleJob& job,
                                      const SampleCallbacks& callbacks, const std::stop_token& stop,
                                      CallStage& stage) {
  grpc::ClientContext context;
  const std::stop_callback cancel(stop, [&context] { context.TryCancel(); });
  const auto reader = stub.Sample(&context, request);
  Answer answer(job, callbacks);
  absl::Status taken;
  v1::SampleResponse message;
  while (taken.ok() && reader->Read(&message)) {
    stage = CallStage::kStreaming;
    taken = answer.Take(message);
  }
  if (!taken.ok()) context.TryCancel();
  const grpc::Status status = reader->Finish();
  if (!taken.ok()) return taken;
  // The whole answer may have come before the stop took effect.
  if (status.ok()) return answer.Finish();
  if (stop.stop_requested()) return Cancelled();
  return FromGrpcStatus(status, stage);
}

// False when stopped while waiting.
bool WaitBeforeRetry(int attempt, const absl::Status& status, const std::stop_token& stop) {
  const double backoff = kFirstRetrySeconds * (1 << attempt);
  const double seconds =
      std::min(kMaxRetrySeconds, std::max(backoff, RetryDelaySeconds(status).value_or(0.0)));
  std::mutex mutex;
  std::condition_variable_any never;
  std::unique_lock lock(mutex);
  never.wait_for(lock, stop, std::chrono::duration<double>(seconds), [] { return false; });
  return !stop.stop_requested();
}

}  // namespace

absl::StatusOr<Client> Client::Connect(const Connection& connection) {
  CCST_ASSIGN_OR_RETURN(const auto channel, OpenChannel(connection));
  return Client(v1::SamplingService::NewStub(channel), v1::ServerInfoService::NewStub(channel));
}

Client::Client(std::unique_ptr<v1::SamplingService::StubInterface> sampling,
               std::unique_ptr<v1::ServerInfoService::StubInterface> info)
    : sampling_(std::move(sampling)), info_(std::move(info)) {}

absl::StatusOr<SampleOutcome> Client::Sample(const SampleJob& job, const SampleCallbacks& callbacks,
                                             const std::stop_token& stop) {
  const v1::SampleRequest request = ToRequest(job);
  for (int attempt = 0;; ++attempt) {
    if (stop.stop_requested()) return Cancelled();
    CallStage stage = CallStage::kBeforeFirstMessage;
    auto outcome = Attempt(*sampling_, request, job, callbacks, stop, stage);
    const bool again = absl::IsUnavailable(outcome.status()) &&
                       stage == CallStage::kBeforeFirstMessage && attempt + 1 < kAttempts;
    if (!again) return outcome;
    if (!WaitBeforeRetry(attempt, outcome.status(), stop)) return Cancelled();
  }
}

absl::StatusOr<v1::GetServerInfoResponse> Client::GetServerInfo() {
  grpc::ClientContext context;
  context.set_deadline(std::chrono::system_clock::now() + kInfoTimeout);
  v1::GetServerInfoResponse response;
  const grpc::Status status = info_->GetServerInfo(&context, {}, &response);
  if (!status.ok()) return FromGrpcStatus(status, CallStage::kBeforeFirstMessage);
  return response;
}

}  // namespace ccst
