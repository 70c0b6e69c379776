#pragma once

#include <cstdint>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"

namespace ccst::io {

/// All bytes of a file or pipe.
/// @errors NOT_FOUND | PERMISSION_DENIED | UNKNOWN, with the path and the system's reason;
///         INVALID_ARGUMENT LIMIT_EXCEEDED more than `max_bytes`
absl::StatusOr<std::string> ReadWholeFile(const std::string& path, std::int64_t max_bytes);

/// The status of a failed system call: `path: what: the reason`.
absl::Status SystemError(int error_number, const std::string& path, const char* what);

}  // namespace ccst::io
