#include <cstdint>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_format.h"
#include "client/lib/answer_bounds.h"
#include "client/lib/checked_outcome.h"
#include "client/lib/client.h"
#include "client/lib/unary_call.h"
#include "core/base/status.h"
#include "proto/convert/options.h"
#include "proto/convert/scalars.h"

namespace ccst {
namespace {

// Small enough for a message of 4 MiB, whatever labels and errors the jobs have.
constexpr int kPageSize = 200;

// 128 random bits: a name that no other call has.
std::string NewRequestId() {
  std::random_device random;
  std::string id;
  for (int i = 0; i < 4; ++i) absl::StrAppendFormat(&id, "%08x", random());
  return id;
}

}  // namespace

absl::StatusOr<v1::Job> Client::CreateJob(const SampleJob& job, const UploadProgress& on_upload,
                                          const std::stop_token& stop) {
  v1::CreateJobRequest request;
  *request.mutable_spec()->mutable_options() = ToProto(job.options);
  if (!job.origin.isZero(0.0)) *request.mutable_spec()->mutable_origin() = ToProto(job.origin);
  request.set_request_id(NewRequestId());
  request.set_display_name(job.display_name);
  request.mutable_labels()->insert(job.labels.begin(), job.labels.end());
  request.set_skip_cache_lookup(job.skip_cache_lookup);
  v1::Job created;
  CCST_RETURN_IF_ERROR(OnStoredMesh(job, on_upload, stop, [&](const std::string& mesh) {
    request.mutable_spec()->set_mesh(mesh);
    auto response = RepeatableCall<v1::CreateJobResponse>(stop, [&](auto& context, auto& answer) {
      return sampling_->CreateJob(&context, request, &answer);
    });
    if (response.ok()) created = std::move(*response->mutable_job());
    return response.status();
  }));
  // It will be an argument of commands.
  if (!created.name().starts_with("jobs/") || !IsToken(created.name())) {
    return BrokenAnswer("a job that has no name");
  }
  return created;
}

absl::StatusOr<std::vector<v1::Job>> Client::ListJobs(
    const std::vector<v1::Job::State>& states, const std::map<std::string, std::string>& labels,
    const std::stop_token& stop) {
  std::vector<v1::Job> jobs;
  ListBounds bounds(kPageSize);
  v1::ListJobsRequest request;
  request.set_page_size(kPageSize);
  for (const v1::Job::State state : states) request.add_states(state);
  request.mutable_labels()->insert(labels.begin(), labels.end());
  do {
    CCST_ASSIGN_OR_RETURN(
        const auto page,
        RepeatableCall<v1::ListJobsResponse>(stop, [&](auto& context, auto& answer) {
          return sampling_->ListJobs(&context, request, &answer);
        }));
    CCST_RETURN_IF_ERROR(bounds.Take(page.jobs_size(), page.ByteSizeLong(), request.page_token(),
                                     page.next_page_token()));
    jobs.insert(jobs.end(), page.jobs().begin(), page.jobs().end());
    request.set_page_token(page.next_page_token());
  } while (!request.page_token().empty());
  return jobs;
}

absl::StatusOr<v1::Job> Client::CancelJob(const std::string& name) {
  v1::CancelJobRequest request;
  request.set_name(name);
  CCST_ASSIGN_OR_RETURN(const auto response,
                        RepeatableCall<v1::CancelJobResponse>({}, [&](auto& context, auto& answer) {
                          return sampling_->CancelJob(&context, request, &answer);
                        }));
  return response.job();
}

absl::Status Client::DeleteJob(const std::string& name) {
  v1::DeleteJobRequest request;
  request.set_name(name);
  return RepeatableCall<v1::DeleteJobResponse>(
             {}, [&](auto& context,
                     auto& answer) { return sampling_->DeleteJob(&context, request, &answer); })
      .status();
}

}  // namespace ccst
