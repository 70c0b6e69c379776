#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include <Eigen/Core>

#include "absl/status/statusor.h"
#include "ccst/v1/job.pb.h"
#include "ccst/v1/sampling_service.pb.h"
#include "core/sampling/sampling.h"
#include "proto/convert/options.h"

namespace ccst {

/// Largest `preview_sample_count`.
inline constexpr int kMaxPreviewSampleCount = 65'536;

/// A checked `SampleRequest` or `CreateJobRequest`, without the bytes of an inline mesh.
struct JobCall {
  std::string mesh_sha256;  ///< Empty when the mesh is inline.
  SamplingOptions options;
  std::optional<Eigen::Vector3d> origin;
  int preview_sample_count = 0;
  std::string display_name;
  std::map<std::string, std::string> labels;
  bool skip_cache_lookup = false;

  // Of a `CreateJobRequest` alone.
  std::string request_id;
  bool validate_only = false;
  std::optional<double> abandon_seconds;
};

/// INVALID_ARGUMENT with all violations, see Violations::ToStatus(); those of CheckFieldLimits()
/// are among them.
absl::StatusOr<JobCall> FromProto(const v1::SampleRequest& request,
                                  const RequestLimits& limits = {});
absl::StatusOr<JobCall> FromProto(const v1::CreateJobRequest& request,
                                  const RequestLimits& limits = {});

/// Adds to `violations` when `count` is no number of preview points.
void CheckPreview(int count, Violations& violations);

/// The labels asked for; adds to `violations` where a key is empty.
std::map<std::string, std::string> LabelsFromProto(
    const google::protobuf::Map<std::string, std::string>& labels, const std::string& path,
    Violations& violations);

}  // namespace ccst
