#include "server/rpc/server_info_service.h"

#include <string>
#include <utility>

#include "core/base/version.h"
#include "core/io/image_file.h"
#include "core/mesh/attributes.h"
#include "core/sampling/algorithm_revision.h"
#include "core/sampling/sampling.h"
#include "proto/convert/scalars.h"

namespace ccst::server {

v1::ServerLimits LimitsToProto(const RequestLimits& request, const MeshStoreOptions& meshes,
                               const MeshServiceOptions& transfers, const JobManagerOptions& jobs,
                               const StreamLimits& streams, std::int64_t max_data_bytes) {
  v1::ServerLimits limits;
  limits.set_max_mesh_bytes(meshes.max_mesh_bytes);
  limits.set_max_inline_mesh_bytes(request.max_inline_mesh_bytes);
  limits.set_max_chunk_bytes(transfers.max_chunk_bytes);
  limits.set_max_stored_mesh_bytes(meshes.max_stored_bytes);
  limits.set_max_vertex_count(meshes.decode_limits.max_vertices);
  limits.set_max_face_count(meshes.decode_limits.max_faces);
  limits.set_max_sample_count(request.max_sample_count);
  limits.set_max_iterations(request.max_iterations);
  limits.set_max_texture_bytes(request.max_texture_bytes);
  limits.set_max_queued_jobs(jobs.runner.max_queued_jobs);
  limits.set_max_queued_jobs_per_caller(jobs.runner.max_queued_jobs_per_caller);
  limits.set_max_running_jobs(jobs.runner.max_running_jobs);
  limits.set_max_watchers_per_job(jobs.max_watchers_per_job);
  limits.set_max_job_memory_bytes(jobs.memory_budget_bytes);
  limits.set_max_texture_pixels(ImageLimits{}.max_pixels);
  limits.set_max_uploads_per_caller(transfers.max_uploads_per_caller);
  limits.set_max_data_bytes(max_data_bytes);
  limits.set_max_stream_bytes_per_caller(streams.most_bytes_of_caller());
  limits.set_max_stream_bytes(streams.most_bytes);
  limits.set_max_decoded_mesh_bytes(meshes.decode_limits.max_decoded_bytes);
  limits.set_max_attribute_count(static_cast<std::int32_t>(kMaxAttributes));
  limits.set_max_record_bytes_per_caller(jobs.records.max_owner_bytes);
  *limits.mutable_max_job_duration() = DurationToProto(request.max_job_seconds);
  *limits.mutable_job_retention_duration() = DurationToProto(absl::ToDoubleSeconds(jobs.retention));
  *limits.mutable_mesh_retention_duration() =
      DurationToProto(absl::ToDoubleSeconds(meshes.retention));
  return limits;
}

ServerInfoService::ServerInfoService(const JobManager& jobs, const CallSupport& support,
                                     v1::ServerLimits limits)
    : jobs_(jobs), support_(support), limits_(std::move(limits)) {}

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
  const RunnerLoad load = jobs_.Load();
  response.mutable_load()->set_queued_job_count(load.queued);
  response.mutable_load()->set_running_job_count(load.running);
}

}  // namespace ccst::server
