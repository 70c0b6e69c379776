#pragma once

#include <cstdint>
#include <string>

#include "absl/status/statusor.h"

namespace ccst::server {

/// What tells a changed file from an unchanged one, without reading it. All zero when there is no
/// such file.
struct FileStamp {
  std::uint64_t device = 0;
  std::uint64_t inode = 0;
  std::int64_t size = 0;
  std::int64_t modified = 0;  ///< [ns]
  std::int64_t changed = 0;   ///< Of the inode [ns].

  bool operator==(const FileStamp&) const = default;
};

/// The stamp of the file at `path` now; follows links, so that a swapped link counts as a change.
FileStamp StampOf(const std::string& path);

/// All of a small file.
/// @errors NOT_FOUND OPTION_INVALID  it is not there, a folder or not readable, or over 1 MiB; does
///         not name the path
absl::StatusOr<std::string> ReadSmallFile(const std::string& path);

}  // namespace ccst::server
