#pragma once

#include <memory>

#include "absl/status/statusor.h"
#include "ccst/v1/sampling_service.pb.h"
#include "proto/convert/job_request.h"
#include "server/auth/caller.h"
#include "server/jobs/job_analyst.h"
#include "server/jobs/job_manager.h"
#include "server/meshes/mesh_store.h"

namespace ccst::server {

/// Where jobs and their meshes live; outlives the services.
struct JobSupport {
  JobManager& jobs;
  MeshStore& meshes;
  BlobStore& blobs;
  BlobPins& pins;
  JobAnalyst& analyst;
  Executor& disk;      ///< Short work that blocks on the disk.
  Executor& analyses;  ///< Long work: what jobs left is measured.
  RequestLimits limits;
};

/// Makes a job of a request: checks it, stores image and inline mesh, a small one not before it is
/// sampled, and has the job accepted. Blocks on the disk. Lets go of the mesh's bytes in `request`.
/// @errors those of FromProto() and JobManager::Create() | FAILED_PRECONDITION MESH_MISSING
absl::StatusOr<std::shared_ptr<Job>> Submit(const JobSupport& support, const Caller& caller,
                                            JobCall call, v1::SampleRequest& request);

/// The same. Where the request only asks for a check, the job is none that can be found.
absl::StatusOr<v1::Job> Submit(const JobSupport& support, const Caller& caller,
                               const v1::CreateJobRequest& request);

}  // namespace ccst::server
