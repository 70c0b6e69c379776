#include "server/rpc/job_intake.h"

#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/sha256.h"
#include "core/base/status.h"
#include "proto/convert/names.h"
#include "proto/convert/status.h"
#include "proto/convert/violations.h"
#include "server/rpc/job_messages.h"

namespace ccst::server {
namespace {

absl::Status MeshMissing(const std::string& sha256, const std::string& why) {
  absl::Status status =
      MakeError(absl::StatusCode::kFailedPrecondition, ErrorReason::kMeshMissing,
                absl::StrCat("the mesh ", MeshName(sha256), " ", why, "; upload it and ask again"));
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

  // Stores `bytes`, which is nothing to do when they are there undamaged. They go with these pins
  // unless a record refers to them by then, as where the job is refused.
  absl::Status Store(const std::string& sha256, std::string_view bytes) {
    Hold(sha256);
    CCST_RETURN_IF_ERROR(support_.pins.Drop(sha256));
    if (support_.blobs.Check(sha256).ok()) return absl::OkStatus();
    return PutWhole(support_.blobs, bytes).status();
  }

 private:
  const JobSupport& support_;
  std::vector<std::unique_ptr<BlobPins::Pin>> pins_;
};

absl::Status UseStoredMesh(const JobSupport& support, const Caller& caller,
                           const std::string& sha256, Pins& pins) {
  pins.Hold(sha256);
  const auto mesh = support.meshes.Use(caller.visible_owner(), sha256);
  if (absl::IsNotFound(mesh.status())) return MeshMissing(sha256, "is not stored");
  if (absl::IsDataLoss(mesh.status())) return MeshMissing(sha256, "is damaged where it is stored");
  return mesh.status();
}

// The image of a texture density stays apart.
struct Asked {
  JobSpec spec;
  std::shared_ptr<const std::string> image;
};

Asked MakeSpec(const Caller& caller, JobCall call) {
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
  auto image = std::exchange(spec.options.density.encoded_image, nullptr);
  if (image != nullptr) spec.texture_sha256 = Sha256Of(*image);
  return {.spec = std::move(spec), .image = std::move(image)};
}

// Names the field where a request_id is that of another job.
absl::Status OfRequestId(const absl::Status& status) {
  if (GetErrorReason(status) != ErrorReason::kRequestInvalid) return status;
  Violations violations;
  violations.Add("request_id", std::string(status.message()), ErrorReason::kRequestInvalid);
  return violations.ToStatus();
}

}  // namespace

absl::StatusOr<std::shared_ptr<Job>> Submit(const JobSupport& support, const Caller& caller,
                                            JobCall call, v1::SampleRequest& request) {
  Pins pins(support);
  std::shared_ptr<const HeldInput> held;
  if (call.mesh_sha256.empty()) {
    std::string bytes = std::move(*request.mutable_inline_mesh()->mutable_data());
    call.mesh_sha256 = Sha256Of(bytes);
    held = support.jobs.Hold(call.mesh_sha256, bytes);
    if (held != nullptr) {
      pins.Hold(call.mesh_sha256);
    } else {
      CCST_RETURN_IF_ERROR(pins.Store(call.mesh_sha256, bytes));
    }
  } else {
    CCST_RETURN_IF_ERROR(UseStoredMesh(support, caller, call.mesh_sha256, pins));
  }
  auto [spec, image] = MakeSpec(caller, std::move(call));
  if (image != nullptr) CCST_RETURN_IF_ERROR(pins.Store(spec.texture_sha256, *image));
  spec.ends_with_caller = true;
  return support.jobs.Create(spec, held);
}

absl::StatusOr<v1::Job> Submit(const JobSupport& support, const Caller& caller,
                               const v1::CreateJobRequest& request) {
  JobCall call;
  CCST_ASSIGN_OR_RETURN(call, FromProto(request, support.limits));
  const bool validate_only = call.validate_only;
  auto [spec, image] = MakeSpec(caller, std::move(call));
  if (!validate_only) {
    // Before anything is asked of the mesh, which may be gone, or of the disk, which may be full.
    const auto earlier = support.jobs.FindRequest(spec);
    if (!earlier.ok()) return OfRequestId(earlier.status());
    if (*earlier != nullptr) return ToProto(**earlier);
  }
  Pins pins(support);
  CCST_RETURN_IF_ERROR(UseStoredMesh(support, caller, spec.mesh_sha256, pins));
  if (image != nullptr) CCST_RETURN_IF_ERROR(pins.Store(spec.texture_sha256, *image));
  if (validate_only) {
    CCST_RETURN_IF_ERROR(support.jobs.Check(spec));
    return ToProto("", spec, JobView{});
  }
  const auto job = support.jobs.Create(spec);
  if (!job.ok()) return OfRequestId(job.status());
  return ToProto(**job);
}

}  // namespace ccst::server
