#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "absl/status/status.h"
#include "absl/status/statusor.h"

namespace ccst {

/// Machine-readable cause of a refusal; travels as a payload of absl::Status and becomes
/// `ErrorInfo.reason` on the wire. The catalogue is proto/docs/errors.md.
enum class ErrorReason {
  kOptionInvalid,        ///< An option is outside its range.
  kMeshUnreadable,       ///< The bytes are not a mesh of the named format.
  kDracoDecodeFailed,    ///< The bytes are not a Draco mesh.
  kMeshEmpty,            ///< No face of positive area.
  kMeshDegenerate,       ///< Non-finite coordinates or indices out of range.
  kMeshNotManifold,      ///< An edge, a vertex or the orientation is not that of a 2-manifold.
  kImageUnreadable,      ///< The bytes are not an image of a known format.
  kDensityInvalid,       ///< A density is negative, not finite or zero everywhere, or is missing.
  kCountTooSmall,        ///< Fewer samples than the surface's topology needs.
  kLimitExceeded,        ///< An announced limit was passed.
  kUnauthenticated,      ///< The server does not know who calls: no token, or not a right one.
  kPermissionDenied,     ///< The caller is known and may not do this.
  kRequestInvalid,       ///< A part of the request is missing or of the wrong form.
  kDigestMismatch,       ///< Bytes are not those their digest or size announced.
  kChunkOffsetMismatch,  ///< A chunk does not follow the one before.
  kMeshMissing,          ///< The mesh referred to is not stored.
  kMeshInUse,            ///< The mesh is needed by a job that has not ended.
  kJobNotEnded,          ///< The job has not ended yet.
  kJobHasNoSamples,      ///< The job failed or was cancelled.
  kNotFound,             ///< No such job or mesh, not any more, or another caller's.
  kQuotaExceeded,        ///< The caller's share of something is used up.
  kStorageFull,          ///< The disk is full.
  kStorageFailed,        ///< What is stored cannot be read or written.
  kQueueFull,            ///< No more jobs may wait just now.
  kDraining,             ///< The server is going away.
  kCancelled,            ///< The caller went away or asked to stop.
  kOutOfMemory,          ///< The computation needs more memory than there is.
  kTimeLimitExceeded,    ///< The time limit passed before there was a result.
  kInternal,             ///< A fault of the program.
};

/// UPPER_SNAKE_CASE name, for example `MESH_NOT_MANIFOLD`.
std::string_view ErrorReasonName(ErrorReason reason);

/// A status that carries `reason`.
absl::Status MakeError(absl::StatusCode code, ErrorReason reason, std::string_view message);

/// The reason inside `status`; empty when it carries none.
std::optional<ErrorReason> GetErrorReason(const absl::Status& status);

}  // namespace ccst

/// Returns from the enclosing function when `expression` is not OK.
#define CCST_RETURN_IF_ERROR(expression)                                                   \
  do {                                                                                     \
    if (absl::Status ccst_status_ = (expression); !ccst_status_.ok()) return ccst_status_; \
  } while (false)

#define CCST_CONCAT_INNER_(a, b) a##b
#define CCST_CONCAT_(a, b) CCST_CONCAT_INNER_(a, b)
#define CCST_ASSIGN_OR_RETURN_IMPL_(result, lhs, expression) \
  auto result = (expression);                                \
  if (!result.ok()) return result.status();                  \
  lhs = *std::move(result)

/// Assigns the value of a StatusOr or returns its error.
#define CCST_ASSIGN_OR_RETURN(lhs, expression) \
  CCST_ASSIGN_OR_RETURN_IMPL_(CCST_CONCAT_(ccst_result_, __LINE__), lhs, expression)
