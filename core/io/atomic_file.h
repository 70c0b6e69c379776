#pragma once

#include <string>
#include <string_view>

#include "absl/status/status.h"

namespace ccst {

/// Writes `contents` to `path` so that `path` holds either what it held before or all of
/// `contents`: writes a file beside it, flushes it to the disk, renames it. The file keeps the
/// permissions of the one it replaces, else it gets those of the umask. A path that is a device
/// or a pipe is written in place; `-` is standard output.
/// @errors NOT_FOUND | PERMISSION_DENIED | RESOURCE_EXHAUSTED (no space) | UNKNOWN, with the path
///         and the system's reason
absl::Status WriteFileAtomically(const std::string& path, std::string_view contents);

}  // namespace ccst
