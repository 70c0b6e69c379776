#include "server/store/known_blobs.h"

#include <ctime>

namespace ccst::server {
namespace {

// A few MiB; whatever is over it is read again when it is asked for next.
constexpr std::size_t kMostKnown = 50'000;

}  // namespace

bool KnownBlobs::Look::operator==(const Look& other) const {
  return inode == other.inode && size == other.size && changed.tv_sec == other.changed.tv_sec &&
         changed.tv_nsec == other.changed.tv_nsec;
}

KnownBlobs::Look KnownBlobs::LookAt(const FileDescriptor& file) {
  struct stat facts = {};
  if (fstat(file.number(), &facts) != 0) return {};
  return {.inode = facts.st_ino, .size = facts.st_size, .changed = facts.st_mtim};
}

void KnownBlobs::Add(const std::string& sha256, const FileDescriptor& file) {
  timespec times[2] = {{.tv_sec = 0, .tv_nsec = UTIME_OMIT}, {}};
  clock_gettime(CLOCK_REALTIME, &times[1]);
  --times[1].tv_sec;
  // Where this is not permitted the next question reads the file again.
  if (futimens(file.number(), times) != 0) return;
  const Look look = LookAt(file);
  MutexLock lock(mutex_);
  if (known_.size() >= kMostKnown) known_.clear();
  known_[sha256] = look;
}

bool KnownBlobs::Contains(const std::string& sha256, const FileDescriptor& file) const {
  const Look look = LookAt(file);
  MutexLock lock(mutex_);
  const auto known = known_.find(sha256);
  return known != known_.end() && known->second == look;
}

void KnownBlobs::Forget(const std::string& sha256) {
  MutexLock lock(mutex_);
  known_.erase(sha256);
}

}  // namespace ccst::server
