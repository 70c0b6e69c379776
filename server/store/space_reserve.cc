#include "server/store/space_reserve.h"

#include <algorithm>
#include <cerrno>
#include <memory>
#include <utility>

#include <fcntl.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include "core/base/status.h"
#include "server/store/storage_error.h"

namespace ccst::server {
namespace {

constexpr char kName[] = "reserve";
// SQLite writes its log back once it has 1000 pages of 4 KiB; twice that.
constexpr std::int64_t kLargestBytes = std::int64_t{8} << 20;
// One change of the records may take a hundred pages.
constexpr std::int64_t kSmallestBytes = std::int64_t{512} << 10;
constexpr std::int64_t kShareOfDisk = 16;

}  // namespace

absl::StatusOr<std::unique_ptr<SpaceReserve>> SpaceReserve::Open(const FileDescriptor& directory) {
  FileDescriptor file(
      openat(directory.number(), kName, O_RDWR | O_CREAT | O_CLOEXEC, S_IRUSR | S_IWUSR));
  struct statvfs disk = {};
  if (!file.is_open() || fstatvfs(file.number(), &disk) != 0) {
    return FileError(errno, "cannot open the reserve");
  }
  const auto disk_bytes = static_cast<std::int64_t>(disk.f_blocks * disk.f_frsize);
  std::unique_ptr<SpaceReserve> reserve(new SpaceReserve(
      std::move(file), std::clamp(disk_bytes / kShareOfDisk, kSmallestBytes, kLargestBytes)));
  reserve->Restore();
  return reserve;
}

bool SpaceReserve::Restore() {
  if (whole_) return true;
  MutexLock lock(mutex_);
  int error = EINTR;
  while (error == EINTR) error = posix_fallocate(file_.number(), 0, size_bytes_);
  // A disk that cannot keep space has no reserve, but is not full for that.
  whole_ = error == 0 || (error != ENOSPC && error != EDQUOT);
  if (error != 0 && ftruncate(file_.number(), 0) != 0) whole_ = false;
  return whole_;
}

void SpaceReserve::GiveUp() {
  MutexLock lock(mutex_);
  whole_ = false;
  if (ftruncate(file_.number(), 0) != 0) whole_ = true;
}

}  // namespace ccst::server
