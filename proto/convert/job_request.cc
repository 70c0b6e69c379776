#include "proto/convert/job_request.h"

#include "proto/convert/field_limits.h"
#include "proto/convert/names.h"
#include "proto/convert/scalars.h"

namespace ccst {
namespace {

constexpr ErrorReason kInvalid = ErrorReason::kRequestInvalid;

void CheckInlineMesh(const v1::InlineMesh& mesh, const RequestLimits& limits,
                     Violations& violations) {
  if (mesh.format() != v1::MESH_FORMAT_DRACO) {
    violations.Add("inline_mesh.format", "must be MESH_FORMAT_DRACO", kInvalid);
  }
  const auto size = static_cast<std::int64_t>(mesh.data().size());
  if (size == 0) {
    violations.Add("inline_mesh.data", "is empty, must be a Draco mesh", kInvalid);
  } else if (size > limits.max_inline_mesh_bytes) {
    violations.AddLimit("inline_mesh.data", "max_inline_mesh_bytes", limits.max_inline_mesh_bytes,
                        size);
  }
}

std::optional<Eigen::Vector3d> Origin(bool has_origin, const v1::Vector3& message,
                                      const std::string& path, Violations& violations) {
  if (!has_origin) return std::nullopt;
  const Eigen::Vector3d origin = FromProto(message);
  if (!origin.allFinite()) violations.Add(path, "must be finite", kInvalid);
  return origin;
}

SamplingOptions Options(bool has_options, const v1::SamplingOptions& options,
                        const std::string& path, const RequestLimits& limits,
                        Violations& violations) {
  if (has_options) return FromProto(options, limits, path, violations);
  violations.Add(path, "is missing, must at least have a sample_count", kInvalid);
  return {};
}

}  // namespace

void CheckPreview(int count, Violations& violations) {
  if (count >= 0 && count <= kMaxPreviewSampleCount) return;
  violations.Add("preview_sample_count", "is " + std::to_string(count) + ", must be in [0, " +
                                             std::to_string(kMaxPreviewSampleCount) + "]");
}

std::map<std::string, std::string> LabelsFromProto(
    const google::protobuf::Map<std::string, std::string>& labels, const std::string& path,
    Violations& violations) {
  if (labels.contains("")) violations.Add(path, "has an empty key", kInvalid);
  return {labels.begin(), labels.end()};
}

absl::StatusOr<JobCall> FromProto(const v1::SampleRequest& request, const RequestLimits& limits) {
  Violations violations;
  CheckFieldLimits(request, violations);
  JobCall call;
  if (request.has_inline_mesh()) {
    const v1::InlineMesh& mesh = request.inline_mesh();
    CheckInlineMesh(mesh, limits, violations);
    call.origin = Origin(mesh.has_origin(), mesh.origin(), "inline_mesh.origin", violations);
  } else if (!request.mesh_name().empty()) {
    call.mesh_sha256 = Sha256OfMeshName(request.mesh_name(), "mesh_name", violations);
    call.origin = Origin(request.has_origin(), request.origin(), "origin", violations);
  } else {
    violations.Add("inline_mesh", "is missing, must be a Draco mesh", kInvalid);
  }
  call.options = Options(request.has_options(), request.options(), "options", limits, violations);
  call.preview_sample_count = request.preview_sample_count();
  CheckPreview(call.preview_sample_count, violations);
  CheckText(request.display_name(), kMaxDisplayName, "display_name", violations);
  call.display_name = request.display_name();
  call.labels = LabelsFromProto(request.labels(), "labels", violations);
  call.skip_cache_lookup = request.skip_cache_lookup();
  CCST_RETURN_IF_ERROR(violations.ToStatus());
  return call;
}

absl::StatusOr<JobCall> FromProto(const v1::CreateJobRequest& request,
                                  const RequestLimits& limits) {
  Violations violations;
  CheckFieldLimits(request, violations);
  JobCall call;
  const v1::JobSpec& spec = request.spec();
  call.mesh_sha256 = Sha256OfMeshName(spec.mesh(), "spec.mesh", violations);
  call.origin = Origin(spec.has_origin(), spec.origin(), "spec.origin", violations);
  call.options = Options(spec.has_options(), spec.options(), "spec.options", limits, violations);
  call.request_id = request.request_id();
  CheckText(request.display_name(), kMaxDisplayName, "display_name", violations);
  call.display_name = request.display_name();
  call.labels = LabelsFromProto(request.labels(), "labels", violations);
  call.skip_cache_lookup = request.skip_cache_lookup();
  call.validate_only = request.validate_only();
  if (request.has_abandon_timeout()) {
    if (!IsPositiveDuration(request.abandon_timeout())) {
      violations.Add("abandon_timeout", "must be a valid duration above 0", kInvalid);
    }
    call.abandon_seconds = SecondsFromProto(request.abandon_timeout());
  }
  CCST_RETURN_IF_ERROR(violations.ToStatus());
  return call;
}

}  // namespace ccst
