#pragma once

#include <atomic>
#include <cstdint>
#include <memory>

#include "absl/status/statusor.h"
#include "server/base/mutex.h"
#include "server/store/files.h"

namespace ccst::server {

/// Space of the disk that is kept for deleting: to remove a record, its change must first be
/// written to the log, for which a full disk has no room. It is a file without content of worth,
/// given up when a deletion needs its space and made again as soon as there is some. While it is
/// not whole, nothing may be written but what frees space. Thread-safe.
class SpaceReserve {
 public:
  /// The file `reserve` in `directory`; it is made whole where the disk has the space. Takes a
  /// sixteenth of the disk, within 512 KiB and 8 MiB.
  /// @errors RESOURCE_EXHAUSTED STORAGE_FULL | INTERNAL STORAGE_FAILED when there can be no file
  static absl::StatusOr<std::unique_ptr<SpaceReserve>> Open(const FileDescriptor& directory);

  /// Makes it whole where it is not; false when the disk is too full for that. Costs nothing when
  /// it is whole.
  bool Restore();
  /// Leaves its space to others.
  void GiveUp();
  bool is_whole() const { return whole_; }

 private:
  SpaceReserve(FileDescriptor file, std::int64_t size_bytes)
      : file_(std::move(file)), size_bytes_(size_bytes) {}

  const FileDescriptor file_;  // Open all the time, as descriptors may be short when it is needed.
  const std::int64_t size_bytes_;
  Mutex mutex_;
  std::atomic<bool> whole_ = false;  // Changes with mutex_ held.
};

}  // namespace ccst::server
