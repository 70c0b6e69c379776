#include "server/rpc/job_intake.h"

#include <string>
#include <utility>

#include "core/base/sha256.h"
#include "core/base/status.h"
#include "proto/convert/names.h"
#include "proto/convert/status.h"
#include "server/rpc/job_messages.h"

namespace ccst::server {
namespace {

absl::Status MeshMissing(const std::string& sha256) {
  absl::Status status =
      MakeError(absl::StatusCode::kFailedPrecondition, ErrorReason::kMeshMissing,
                "the mesh " + MeshName(sha256) + " is not stored; upload it and ask again");
  v1::MissingMeshes missing;
  missing.add_meshes(MeshName(sha256));
  SetDetail(missing, status);
  return status;
}

// Blobs of a job that is not yet stored, which would refer to them.
class Pins {
 public:
  explicit Pins(const JobSupport& support) : support_(support) {}

  void Hold(const std::string& sha256) {
    pins_.push_back(std::make_unique<BlobPins::Pin>(support_.pins, sha256));
  }

  // Stores `bytes`, which is nothing to do when they are there.
  absl::StatusOr<std::string> Store(std::string_view bytes) {
    std::string sha256 = Sha256Of(bytes);
    Hold(sha256);
    if (!support_.blobs.Contains(sha256)) {
      CCST_ASSIGN_OR_RETURN(sha256, PutWhole(support_.blobs, bytes));
    }
    return sha256;
  }

 private:
  const JobSupport& support_;
  std::vector<std::unique_ptr<BlobPins::Pin>> pins_;
};

absl::Status UseStoredMesh(const JobSupport& support, const Caller& caller,
                           const std::string& sha256, Pins& pins) {
  pins.Hold(sha256);
  const auto mesh = support.meshes.Use(caller.visible_owner(), sha256);
  if (absl::IsNotFound(mesh.status())) return MeshMissing(sha256);
  return mesh.status();
}

absl::StatusOr<JobSpec> MakeSpec(const Caller& caller, JobCall call, Pins& pins) {
  JobSpec spec;
  spec.owner = caller.visible_owner();
  spec.share = caller.owner;
  spec.request_id = std::move(call.request_id);
  spec.display_name = std::move(call.display_name);
  spec.labels = std::move(call.labels);
  spec.mesh_sha256 = std::move(call.mesh_sha256);
  spec.options = std::move(call.options);
  spec.origin = call.origin;
  spec.abandon_seconds = call.abandon_seconds;
  spec.skip_cache_lookup = call.skip_cache_lookup;
  if (auto& image = spec.options.density.encoded_image; image != nullptr) {
    CCST_ASSIGN_OR_RETURN(spec.texture_sha256, pins.Store(*image));
    image = nullptr;
  }
  return spec;
}

}  // namespace

absl::StatusOr<std::shared_ptr<Job>> Submit(const JobSupport& support, const Caller& caller,
                                            JobCall call, v1::SampleRequest& request) {
  Pins pins(support);
  if (call.mesh_sha256.empty()) {
    const std::string bytes = std::move(*request.mutable_inline_mesh()->mutable_data());
    CCST_ASSIGN_OR_RETURN(call.mesh_sha256, pins.Store(bytes));
  } else {
    CCST_RETURN_IF_ERROR(UseStoredMesh(support, caller, call.mesh_sha256, pins));
  }
  JobSpec spec;
  CCST_ASSIGN_OR_RETURN(spec, MakeSpec(caller, std::move(call), pins));
  spec.ends_with_caller = true;
  return support.jobs.Create(std::move(spec));
}

absl::StatusOr<v1::Job> Submit(const JobSupport& support, const Caller& caller,
                               const v1::CreateJobRequest& request) {
  JobCall call;
  CCST_ASSIGN_OR_RETURN(call, FromProto(request, support.limits));
  Pins pins(support);
  CCST_RETURN_IF_ERROR(UseStoredMesh(support, caller, call.mesh_sha256, pins));
  const bool validate_only = call.validate_only;
  JobSpec spec;
  CCST_ASSIGN_OR_RETURN(spec, MakeSpec(caller, std::move(call), pins));
  if (validate_only) {
    CCST_RETURN_IF_ERROR(support.jobs.Check(spec));
    return ToProto("", spec, JobView{});
  }
  std::shared_ptr<Job> job;
  CCST_ASSIGN_OR_RETURN(job, support.jobs.Create(std::move(spec)));
  return ToProto(*job);
}

}  // namespace ccst::server
