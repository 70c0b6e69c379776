#include "server/rpc/sampling_service.h"

#include <stop_token>
#include <string>
#include <utility>

#include "core/base/status.h"
#include "proto/convert/names.h"
#include "server/rpc/analyze_job.h"
#include "server/rpc/job_messages.h"
#include "server/rpc/mesh_messages.h"
#include "server/rpc/page.h"
#include "server/rpc/read_reactors.h"
#include "server/rpc/sample_reactor.h"
#include "server/rpc/unary.h"
#include "server/rpc/watch_reactor.h"

namespace ccst::server {
namespace {

// The id in a request's `name`.
absl::StatusOr<std::string> IdOf(const std::string& name) {
  Violations violations;
  std::string id = IdOfJobName(name, "name", violations);
  CCST_RETURN_IF_ERROR(violations.ToStatus());
  return id;
}

absl::StatusOr<std::shared_ptr<Job>> FindJob(const JobSupport& jobs, const std::string& name,
                                             Call& call) {
  std::string id;
  CCST_ASSIGN_OR_RETURN(id, IdOf(name));
  std::shared_ptr<Job> job;
  CCST_ASSIGN_OR_RETURN(job, jobs.jobs.Find(call.caller().visible_owner(), id));
  call.record().job = job->name();
  return job;
}

}  // namespace

SamplingService::SamplingService(const StreamSupport& support, const JobSupport& jobs)
    : support_(support), jobs_(jobs) {}

grpc::ServerWriteReactor<v1::SampleResponse>* SamplingService::Sample(
    grpc::CallbackServerContext* context, const v1::SampleRequest* request) {
  // The request is this call's alone, and no const object: gRPC parsed it and keeps it until the
  // call is done. Moving the mesh out lets go of it once it is stored.
  return SampleReactor::Make<SampleReactor>(support_, jobs_, *context,
                                            const_cast<v1::SampleRequest&>(*request));
}

grpc::ServerUnaryReactor* SamplingService::CreateJob(grpc::CallbackServerContext* context,
                                                     const v1::CreateJobRequest* request,
                                                     v1::CreateJobResponse* response) {
  return ServeUnaryOn(jobs_.disk, support_.calls, *context, "CreateJob", Scope::kFull, *request,
                      *response, [this, request, response](Call& call) -> absl::Status {
                        v1::Job job;
                        CCST_ASSIGN_OR_RETURN(job, Submit(jobs_, call.caller(), *request));
                        call.record().job = job.name();
                        call.record().samples_requested = job.effective_options().sample_count();
                        *response->mutable_job() = std::move(job);
                        return absl::OkStatus();
                      });
}

grpc::ServerUnaryReactor* SamplingService::GetJob(grpc::CallbackServerContext* context,
                                                  const v1::GetJobRequest* request,
                                                  v1::GetJobResponse* response) {
  return ServeUnaryOn(jobs_.disk, support_.calls, *context, "GetJob", Scope::kReadOnly, *request,
                      *response, [this, request, response](Call& call) -> absl::Status {
                        std::shared_ptr<Job> job;
                        CCST_ASSIGN_OR_RETURN(job, FindJob(jobs_, request->name(), call));
                        *response->mutable_job() = ToProto(*job);
                        return absl::OkStatus();
                      });
}

grpc::ServerUnaryReactor* SamplingService::ListJobs(grpc::CallbackServerContext* context,
                                                    const v1::ListJobsRequest* request,
                                                    v1::ListJobsResponse* response) {
  return ServeUnaryOn(
      jobs_.disk, support_.calls, *context, "ListJobs", Scope::kReadOnly, *request, *response,
      [this, request, response](Call& call) -> absl::Status {
        Violations violations;
        const int page_size = PageSize(request->page_size(), violations);
        const JobFilter filter = FromProto(*request, call.caller().visible_owner(), violations);
        CCST_RETURN_IF_ERROR(violations.ToStatus());
        return FillPage(
            page_size,
            [&](int size) { return jobs_.jobs.List(filter, size, request->page_token()); },
            [](const JobSummary& job) { return ToProto(job.id, job.spec, job.view); },
            *response->mutable_jobs(), *response->mutable_next_page_token());
      });
}

grpc::ServerWriteReactor<v1::WatchJobResponse>* SamplingService::WatchJob(
    grpc::CallbackServerContext* context, const v1::WatchJobRequest* request) {
  return WatchReactor::Make<WatchReactor>(support_, jobs_, *context, *request);
}

grpc::ServerUnaryReactor* SamplingService::CancelJob(grpc::CallbackServerContext* context,
                                                     const v1::CancelJobRequest* request,
                                                     v1::CancelJobResponse* response) {
  return ServeUnaryOn(jobs_.disk, support_.calls, *context, "CancelJob", Scope::kFull, *request,
                      *response, [this, request, response](Call& call) -> absl::Status {
                        std::shared_ptr<Job> job;
                        CCST_ASSIGN_OR_RETURN(job, FindJob(jobs_, request->name(), call));
                        CCST_RETURN_IF_ERROR(jobs_.jobs.Cancel(job, StopCause::kCaller));
                        *response->mutable_job() = ToProto(*job);
                        return absl::OkStatus();
                      });
}

grpc::ServerWriteReactor<v1::ReadSamplesResponse>* SamplingService::ReadSamples(
    grpc::CallbackServerContext* context, const v1::ReadSamplesRequest* request) {
  return ReadSamplesReactor::Make<ReadSamplesReactor>(support_, jobs_, *context, *request);
}

grpc::ServerWriteReactor<v1::ReadSampleMeshResponse>* SamplingService::ReadSampleMesh(
    grpc::CallbackServerContext* context, const v1::ReadSampleMeshRequest* request) {
  return ReadSampleMeshReactor::Make<ReadSampleMeshReactor>(support_, jobs_, *context, *request);
}

grpc::ServerUnaryReactor* SamplingService::DeleteJob(grpc::CallbackServerContext* context,
                                                     const v1::DeleteJobRequest* request,
                                                     v1::DeleteJobResponse* response) {
  return ServeUnaryOn(jobs_.disk, support_.calls, *context, "DeleteJob", Scope::kFull, *request,
                      *response, [this, request](Call& call) -> absl::Status {
                        std::string id;
                        CCST_ASSIGN_OR_RETURN(id, IdOf(request->name()));
                        absl::Status status = jobs_.jobs.Delete(call.caller().visible_owner(), id);
                        // Else nobody knows whether there is such a job.
                        const bool is_known = status.ok() || absl::IsFailedPrecondition(status);
                        if (is_known) call.record().job = JobName(id);
                        return status;
                      });
}

grpc::ServerUnaryReactor* SamplingService::AnalyzeJob(grpc::CallbackServerContext* context,
                                                      const v1::AnalyzeJobRequest* request,
                                                      v1::AnalyzeJobResponse* response) {
  return ServeStoppableOn(
      jobs_.analyses, support_.calls, *context, "AnalyzeJob", Scope::kFull, *request, *response,
      [this, request, response](Call& call, const std::stop_token& stop) -> absl::Status {
        std::shared_ptr<Job> job;
        CCST_ASSIGN_OR_RETURN(job, FindJob(jobs_, request->name(), call));
        JobFigures figures;
        CCST_ASSIGN_OR_RETURN(figures, jobs_.analyst.Measure(*job, stop));
        *response = ToProto(figures);
        return absl::OkStatus();
      });
}

}  // namespace ccst::server
