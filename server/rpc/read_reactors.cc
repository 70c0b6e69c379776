#include "server/rpc/read_reactors.h"

#include <string>
#include <string_view>
#include <utility>

#include "core/base/status.h"
#include "proto/convert/names.h"
#include "proto/convert/samples.h"

namespace ccst::server {
namespace {

// The samples of the job that `name` names.
absl::StatusOr<StoredSamples> Find(const JobSupport& jobs, const std::string& name, Call& call) {
  Violations violations;
  const std::string id = IdOfJobName(name, "name", violations);
  CCST_RETURN_IF_ERROR(violations.ToStatus());
  std::shared_ptr<Job> job;
  CCST_ASSIGN_OR_RETURN(job, jobs.jobs.Find(call.caller().visible_owner(), id));
  call.record().job = job->name();
  return jobs.jobs.OpenSamples(*job);
}

absl::Status CheckStart(std::int64_t start, std::int64_t count) {
  if (start >= 0 && start <= count) return absl::OkStatus();
  Violations violations;
  violations.Add("start_index",
                 "is " + std::to_string(start) + ", must be in [0, " + std::to_string(count) + "]",
                 ErrorReason::kRequestInvalid);
  return violations.ToStatus();
}

// What differs between the two calls, by their messages.

constexpr std::string_view MethodOf(const v1::ReadSamplesRequest&) { return "ReadSamples"; }
constexpr std::string_view MethodOf(const v1::ReadSampleMeshRequest&) { return "ReadSampleMesh"; }

std::int64_t CountOf(const StoredSamples& stored, const v1::ReadSamplesRequest&) {
  return stored.sample_count();
}
std::int64_t CountOf(const StoredSamples& stored, const v1::ReadSampleMeshRequest&) {
  return stored.triangle_count();
}

SampleChunks ChunksFor(StoredSamples stored, const v1::ReadSamplesRequest& request) {
  return {std::move(stored), request.start_index(), 0};
}
SampleChunks ChunksFor(StoredSamples stored, const v1::ReadSampleMeshRequest& request) {
  return {std::move(stored), 0, request.start_index()};
}

bool HasMore(const SampleChunks& chunks, const v1::ReadSamplesResponse&) {
  return chunks.has_sample();
}
bool HasMore(const SampleChunks& chunks, const v1::ReadSampleMeshResponse&) {
  return chunks.has_triangle();
}

absl::Status Fill(SampleChunks& chunks, v1::ReadSamplesResponse& message) {
  return chunks.NextSamples(*message.mutable_samples());
}
absl::Status Fill(SampleChunks& chunks, v1::ReadSampleMeshResponse& message) {
  return chunks.NextTriangles(*message.mutable_sample_mesh());
}

std::int64_t SamplesIn(const v1::ReadSamplesResponse& message) {
  return message.samples().face_indices_size();
}
std::int64_t SamplesIn(const v1::ReadSampleMeshResponse&) { return 0; }

}  // namespace

template <typename Request, typename Response>
ReadReactor<Request, Response>::ReadReactor(const StreamSupport& support, const JobSupport& jobs,
                                            grpc::CallbackServerContext& context,
                                            const Request& request)
    : StreamReactor<Response>(support, context, MethodOf(request), Scope::kReadOnly,
                              kMaxChunkBytes),
      jobs_(jobs),
      request_(request) {}

template <typename Request, typename Response>
absl::Status ReadReactor<Request, Response>::Open(Call& call) {
  CCST_RETURN_IF_ERROR(call.Received(request_));
  auto stored = Find(jobs_, request_.name(), call);
  if (!stored.ok()) return stored.status();
  CCST_RETURN_IF_ERROR(CheckStart(request_.start_index(), CountOf(*stored, request_)));
  chunks_.emplace(ChunksFor(*std::move(stored), request_));
  return absl::OkStatus();
}

template <typename Request, typename Response>
StreamStep ReadReactor<Request, Response>::Next(Response& message) {
  if (!HasMore(*chunks_, message)) return StreamStep::kEnd;
  end_status_ = Fill(*chunks_, message);
  this->call().record().samples_sent += SamplesIn(message);
  return end_status_.ok() ? StreamStep::kWrite : StreamStep::kEnd;
}

template <typename Request, typename Response>
bool ReadReactor<Request, Response>::MoreFollows(const Response& message) {
  return HasMore(*chunks_, message);
}

template class ReadReactor<v1::ReadSamplesRequest, v1::ReadSamplesResponse>;
template class ReadReactor<v1::ReadSampleMeshRequest, v1::ReadSampleMeshResponse>;

}  // namespace ccst::server
