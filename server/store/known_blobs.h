#pragma once

#include <map>
#include <string>

#include <sys/stat.h>

#include "server/base/mutex.h"
#include "server/store/files.h"

namespace ccst::server {

/// The blobs whose files were seen to hold the right bytes, and have not been written to since. So
/// a blob is read in full once, not with every question whether it is there. Bytes that change
/// without a write, as on a disk that fails, do not show here: readers check what they read, and
/// doubt. Holds a bounded number. Thread-safe.
class KnownBlobs {
 public:
  /// The bytes of `file` have this digest. Sets the time of its last change back by a second: file
  /// systems count time in steps of some milliseconds, and a write in the same step would not show.
  void Add(const std::string& sha256, const FileDescriptor& file);
  /// True when `file` is as it was when it was added.
  bool Contains(const std::string& sha256, const FileDescriptor& file) const;
  void Forget(const std::string& sha256);

 private:
  // What a write changes.
  struct Look {
    ino_t inode = 0;
    off_t size = 0;
    timespec changed = {};
    bool operator==(const Look& other) const;
  };
  static Look LookAt(const FileDescriptor& file);

  mutable Mutex mutex_;
  std::map<std::string, Look> known_ ABSL_GUARDED_BY(mutex_);
};

}  // namespace ccst::server
