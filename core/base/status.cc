#include "core/base/status.h"

#include <array>
#include <utility>

#include "absl/strings/cord.h"
#include "absl/strings/string_view.h"

namespace ccst {
namespace {

constexpr char kReasonPayloadUrl[] = "ccst/error-reason";

constexpr std::array<std::pair<ErrorReason, std::string_view>, 29> kReasonNames = {{
    {ErrorReason::kOptionInvalid, "OPTION_INVALID"},
    {ErrorReason::kMeshUnreadable, "MESH_UNREADABLE"},
    {ErrorReason::kDracoDecodeFailed, "DRACO_DECODE_FAILED"},
    {ErrorReason::kMeshEmpty, "MESH_EMPTY"},
    {ErrorReason::kMeshDegenerate, "MESH_DEGENERATE"},
    {ErrorReason::kMeshNotManifold, "MESH_NOT_MANIFOLD"},
    {ErrorReason::kImageUnreadable, "IMAGE_UNREADABLE"},
    {ErrorReason::kDensityInvalid, "DENSITY_INVALID"},
    {ErrorReason::kCountTooSmall, "COUNT_TOO_SMALL"},
    {ErrorReason::kLimitExceeded, "LIMIT_EXCEEDED"},
    {ErrorReason::kUnauthenticated, "UNAUTHENTICATED"},
    {ErrorReason::kPermissionDenied, "PERMISSION_DENIED"},
    {ErrorReason::kRequestInvalid, "REQUEST_INVALID"},
    {ErrorReason::kDigestMismatch, "DIGEST_MISMATCH"},
    {ErrorReason::kChunkOffsetMismatch, "CHUNK_OFFSET_MISMATCH"},
    {ErrorReason::kMeshMissing, "MESH_MISSING"},
    {ErrorReason::kMeshInUse, "MESH_IN_USE"},
    {ErrorReason::kJobNotEnded, "JOB_NOT_ENDED"},
    {ErrorReason::kJobHasNoSamples, "JOB_HAS_NO_SAMPLES"},
    {ErrorReason::kNotFound, "NOT_FOUND"},
    {ErrorReason::kQuotaExceeded, "QUOTA_EXCEEDED"},
    {ErrorReason::kStorageFull, "STORAGE_FULL"},
    {ErrorReason::kStorageFailed, "STORAGE_FAILED"},
    {ErrorReason::kQueueFull, "QUEUE_FULL"},
    {ErrorReason::kDraining, "DRAINING"},
    {ErrorReason::kCancelled, "CANCELLED"},
    {ErrorReason::kOutOfMemory, "OUT_OF_MEMORY"},
    {ErrorReason::kTimeLimitExceeded, "TIME_LIMIT_EXCEEDED"},
    {ErrorReason::kInternal, "INTERNAL"},
}};

}  // namespace

std::string_view ErrorReasonName(ErrorReason reason) {
  for (const auto& [value, name] : kReasonNames) {
    if (value == reason) return name;
  }
  return "UNKNOWN";
}

absl::Status MakeError(absl::StatusCode code, ErrorReason reason, std::string_view message) {
  absl::Status status(code, absl::string_view(message.data(), message.size()));
  status.SetPayload(kReasonPayloadUrl, absl::Cord(std::string(ErrorReasonName(reason))));
  return status;
}

std::optional<ErrorReason> GetErrorReason(const absl::Status& status) {
  const auto payload = status.GetPayload(kReasonPayloadUrl);
  if (!payload.has_value()) return std::nullopt;
  const std::string text(*payload);
  for (const auto& [value, name] : kReasonNames) {
    if (name == text) return value;
  }
  return std::nullopt;
}

}  // namespace ccst
