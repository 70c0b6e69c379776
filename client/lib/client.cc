#include "client/lib/client.h"

#include <chrono>
#include <utility>

#include <grpcpp/client_context.h>

#include "ccst/v1/error.pb.h"
#include "client/lib/answer.h"
#include "client/lib/grpc_error.h"
#include "client/lib/retry.h"
#include "core/base/status.h"
#include "proto/convert/options.h"
#include "proto/convert/scalars.h"
#include "proto/convert/status.h"

namespace ccst {
namespace {

constexpr std::chrono::seconds kInfoTimeout{10};
// Larger meshes are stored first, so that the next run does not send them again.
constexpr std::size_t kMaxInlineBytes = std::size_t{1} << 20;

v1::SampleRequest ToRequest(const SampleJob& job) {
  v1::SampleRequest request;
  *request.mutable_options() = ToProto(job.options);
  request.set_preview_sample_count(job.preview_sample_count);
  request.set_display_name(job.display_name);
  request.mutable_labels()->insert(job.labels.begin(), job.labels.end());
  request.set_skip_cache_lookup(job.skip_cache_lookup);
  return request;
}

v1::SampleRequest InlineRequest(const SampleJob& job) {
  v1::SampleRequest request = ToRequest(job);
  v1::InlineMesh& mesh = *request.mutable_inline_mesh();
  mesh.set_format(v1::MESH_FORMAT_DRACO);
  mesh.set_data(job.draco);
  if (!job.origin.isZero(0.0)) *mesh.mutable_origin() = ToProto(job.origin);
  return request;
}

v1::SampleRequest NamedRequest(const SampleJob& job, const std::string& mesh) {
  v1::SampleRequest request = ToRequest(job);
  request.set_mesh_name(mesh);
  if (!job.origin.isZero(0.0)) *request.mutable_origin() = ToProto(job.origin);
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
  if (stop.stop_requested()) return StoppedError();
  return FromGrpcStatus(status, stage);
}

absl::StatusOr<SampleOutcome> Call(v1::SamplingService::StubInterface& stub,
                                   const v1::SampleRequest& request, const SampleJob& job,
                                   const SampleCallbacks& callbacks, const std::stop_token& stop) {
  Retry retry(stop);
  for (;;) {
    if (stop.stop_requested()) return StoppedError();
    CallStage stage = CallStage::kBeforeFirstMessage;
    auto outcome = Attempt(stub, request, job, callbacks, stop, stage);
    if (outcome.ok() || stage == CallStage::kStreaming) return outcome;
    CCST_RETURN_IF_ERROR(retry.Wait(outcome.status()));
  }
}

bool IsTooLargeInline(const absl::Status& status) {
  v1::LimitViolation violation;
  return GetDetail(status, violation) && violation.limit() == "max_inline_mesh_bytes";
}

}  // namespace

absl::StatusOr<Client> Client::Connect(const Connection& connection) {
  CCST_ASSIGN_OR_RETURN(const auto channel, OpenChannel(connection));
  return Client(channel);
}

Client::Client(const std::shared_ptr<grpc::Channel>& channel)
    : sampling_(v1::SamplingService::NewStub(channel)),
      meshes_(v1::MeshService::NewStub(channel)),
      info_(v1::ServerInfoService::NewStub(channel)) {}

absl::StatusOr<SampleOutcome> Client::Sample(const SampleJob& job, const SampleCallbacks& callbacks,
                                             const std::stop_token& stop) {
  if (job.draco.size() <= kMaxInlineBytes) {
    auto outcome = Call(*sampling_, InlineRequest(job), job, callbacks, stop);
    if (!IsTooLargeInline(outcome.status())) return outcome;
  }
  absl::StatusOr<SampleOutcome> outcome;
  CCST_RETURN_IF_ERROR(OnStoredMesh(job, callbacks.on_upload, stop, [&](const std::string& mesh) {
    outcome = Call(*sampling_, NamedRequest(job, mesh), job, callbacks, stop);
    return outcome.status();
  }));
  return outcome;
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
