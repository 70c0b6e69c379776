#include "server/rpc/server_info_service.h"

#include <string>
#include <utility>

#include "core/base/version.h"
#include "core/sampling/sampling.h"
#include "proto/convert/scalars.h"

namespace ccst::server {

v1::ServerLimits ToProto(const RequestLimits& request, const MeshLimits& mesh,
                         const RunnerOptions& runner) {
  v1::ServerLimits limits;
  limits.set_max_inline_mesh_bytes(request.max_inline_mesh_bytes);
  limits.set_max_vertex_count(mesh.max_vertices);
  limits.set_max_face_count(mesh.max_faces);
  limits.set_max_sample_count(request.max_sample_count);
  limits.set_max_iterations(request.max_iterations);
  limits.set_max_texture_bytes(request.max_texture_bytes);
  limits.set_max_queued_jobs(runner.max_queued_jobs);
  limits.set_max_running_jobs(runner.max_running_jobs);
  *limits.mutable_max_job_duration() = DurationToProto(request.max_job_seconds);
  return limits;
}

ServerInfoService::ServerInfoService(const JobRunner& runner, const CallSupport& support,
                                     v1::ServerLimits limits)
    : runner_(runner), support_(support), limits_(std::move(limits)) {}

grpc::ServerUnaryReactor* ServerInfoService::GetServerInfo(grpc::CallbackServerContext* context,
                                                           const v1::GetServerInfoRequest* request,
                                                           v1::GetServerInfoResponse* response) {
  return ServeUnary(support_, *context, "GetServerInfo", Scope::kReadOnly, *request, *response,
                    [this, response](Call& /*call*/) {
                      Fill(*response);
                      return absl::OkStatus();
                    });
}

void ServerInfoService::Fill(v1::GetServerInfoResponse& response) const {
  response.set_server_version(std::string(ProjectVersion()));
  response.set_source_revision(std::string(SourceRevision()));
  response.set_algorithm_revision(kAlgorithmRevision);
  response.add_mesh_formats(v1::MESH_FORMAT_DRACO);
  *response.mutable_limits() = limits_;
  const RunnerLoad load = runner_.Load();
  response.mutable_load()->set_queued_job_count(load.queued);
  response.mutable_load()->set_running_job_count(load.running);
}

}  // namespace ccst::server
