#include "server/rpc/read_reactors.h"

#include <string>

#include "core/base/status.h"
#include "proto/convert/names.h"

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

}  // namespace

ReadSamplesReactor::ReadSamplesReactor(const StreamSupport& support, const JobSupport& jobs,
                                       const grpc::CallbackServerContext& context,
                                       const v1::ReadSamplesRequest& request)
    : StreamReactor(support, context, "ReadSamples", Scope::kReadOnly),
      jobs_(jobs),
      request_(request) {}

absl::Status ReadSamplesReactor::Open(Call& call) {
  call.Received(request_);
  auto stored = Find(jobs_, request_.name(), call);
  if (!stored.ok()) return stored.status();
  CCST_RETURN_IF_ERROR(CheckStart(request_.start_index(), stored->sample_count()));
  chunks_.emplace(*std::move(stored), request_.start_index(), 0);
  return absl::OkStatus();
}

StreamStep ReadSamplesReactor::Next(v1::ReadSamplesResponse& message) {
  call().record().samples_sent = chunks_->next_sample() - request_.start_index();
  if (!chunks_->has_sample()) return StreamStep::kEnd;
  end_status_ = chunks_->NextSamples(*message.mutable_samples());
  return end_status_.ok() ? StreamStep::kWrite : StreamStep::kEnd;
}

bool ReadSamplesReactor::MoreFollows(const v1::ReadSamplesResponse& /*message*/) {
  return chunks_->has_sample();
}

ReadSampleMeshReactor::ReadSampleMeshReactor(const StreamSupport& support, const JobSupport& jobs,
                                             const grpc::CallbackServerContext& context,
                                             const v1::ReadSampleMeshRequest& request)
    : StreamReactor(support, context, "ReadSampleMesh", Scope::kReadOnly),
      jobs_(jobs),
      request_(request) {}

absl::Status ReadSampleMeshReactor::Open(Call& call) {
  call.Received(request_);
  auto stored = Find(jobs_, request_.name(), call);
  if (!stored.ok()) return stored.status();
  CCST_RETURN_IF_ERROR(CheckStart(request_.start_index(), stored->triangle_count()));
  chunks_.emplace(*std::move(stored), 0, request_.start_index());
  return absl::OkStatus();
}

StreamStep ReadSampleMeshReactor::Next(v1::ReadSampleMeshResponse& message) {
  if (!chunks_->has_triangle()) return StreamStep::kEnd;
  end_status_ = chunks_->NextTriangles(*message.mutable_sample_mesh());
  return end_status_.ok() ? StreamStep::kWrite : StreamStep::kEnd;
}

bool ReadSampleMeshReactor::MoreFollows(const v1::ReadSampleMeshResponse& /*message*/) {
  return chunks_->has_triangle();
}

}  // namespace ccst::server
