#include <cstdint>
#include <string>
#include <utility>

#include <grpcpp/client_context.h>

#include "absl/strings/str_cat.h"
#include "client/lib/answer_bounds.h"
#include "client/lib/checked_outcome.h"
#include "client/lib/client.h"
#include "client/lib/grpc_error.h"
#include "client/lib/retry.h"
#include "client/lib/unary_call.h"
#include "core/base/status.h"

namespace ccst {
namespace {

// How long a server that has answered may be away.
constexpr double kPatienceSeconds = 30.0;

// Reads streams until one ends with OK.
// @param start  (grpc::ClientContext&) -> a reader of messages, from what is missing on
// @param take   (message) -> absl::Status
template <typename Message, typename Start, typename Take>
absl::Status ReadAll(const std::stop_token& stop, const Start& start, const Take& take) {
  Retry retry(stop, kPatienceSeconds);
  for (;;) {
    grpc::ClientContext context;
    const std::stop_callback cancel(stop, [&context] { context.TryCancel(); });
    const auto reader = start(context);
    Message message;
    absl::Status taken;
    while (taken.ok() && reader->Read(&message)) {
      retry.Heard();
      taken = take(message);
    }
    if (!taken.ok()) context.TryCancel();
    const grpc::Status status = reader->Finish();
    if (!taken.ok()) return taken;
    if (status.ok()) return absl::OkStatus();
    CCST_RETURN_IF_ERROR(retry.Wait(FromGrpcStatus(status, CallStage::kStreaming)));
  }
}

}  // namespace

absl::StatusOr<FetchedJob> Client::FetchJob(const std::string& name, const std::stop_token& stop) {
  v1::GetJobRequest get;
  get.set_name(name);
  CCST_ASSIGN_OR_RETURN(auto response,
                        RepeatableCall<v1::GetJobResponse>(stop, [&](auto& context, auto& answer) {
                          return sampling_->GetJob(&context, get, &answer);
                        }));
  FetchedJob fetched;
  fetched.job = std::move(*response.mutable_job());
  if (fetched.job.name() != name) return BrokenAnswer("another job than the one asked for");
  if (!HasEnded(fetched.job)) {
    return MakeError(absl::StatusCode::kFailedPrecondition, ErrorReason::kJobNotEnded,
                     absl::StrCat(name, " has not ended yet"));
  }
  CCST_RETURN_IF_ERROR(EndOf(fetched.job));
  SampleSet samples;
  const auto count = [](const auto& values) { return static_cast<std::int64_t>(values.size()); };
  AnswerBounds bounds;
  CCST_RETURN_IF_ERROR(BoundsOf(fetched.job, bounds));
  CCST_RETURN_IF_ERROR(ReadAll<v1::ReadSamplesResponse>(
      stop,
      [&](grpc::ClientContext& context) {
        v1::ReadSamplesRequest request;
        request.set_name(name);
        request.set_start_index(count(samples.faces));
        return sampling_->ReadSamples(&context, request);
      },
      [&](const v1::ReadSamplesResponse& message) {
        return AppendWithin(bounds, message.samples(), samples);
      }));
  CCST_RETURN_IF_ERROR(ReadAll<v1::ReadSampleMeshResponse>(
      stop,
      [&](grpc::ClientContext& context) {
        v1::ReadSampleMeshRequest request;
        request.set_name(name);
        request.set_start_index(count(samples.triangles));
        return sampling_->ReadSampleMesh(&context, request);
      },
      [&](const v1::ReadSampleMeshResponse& message) {
        return AppendWithin(bounds, message.sample_mesh(), samples);
      }));
  CCST_ASSIGN_OR_RETURN(fetched.outcome, CheckedOutcome(fetched.job, std::move(samples)));
  return fetched;
}

}  // namespace ccst
