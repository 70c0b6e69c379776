#include "server/store/blob_folder.h"

#include <cerrno>
#include <cstdio>

#include <fcntl.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include "absl/strings/str_cat.h"
#include "core/base/sha256.h"
#include "core/base/status.h"
#include "server/store/storage_error.h"

namespace ccst::server {
namespace {

constexpr char kPlacing[] = "cannot write a blob";

// By the first two digits.
std::string FolderOf(const std::string& sha256) { return sha256.substr(0, 2); }

}  // namespace

std::string BlobFolder::PathOf(const std::string& sha256) {
  return absl::StrCat(FolderOf(sha256), "/", sha256);
}

bool BlobFolder::Contains(const std::string& sha256) const {
  return IsSha256(sha256) && faccessat(directory_.number(), PathOf(sha256).c_str(), F_OK, 0) == 0;
}

std::int64_t BlobFolder::SizeOf(const std::string& sha256) const {
  struct stat facts = {};
  const bool found =
      IsSha256(sha256) && fstatat(directory_.number(), PathOf(sha256).c_str(), &facts, 0) == 0;
  return found ? facts.st_size : 0;
}

absl::Status BlobFolder::CheckRoom(std::int64_t bytes) const {
  CCST_RETURN_IF_ERROR(space_.Check(bytes));
  struct statvfs disk = {};
  if (fstatvfs(directory_.number(), &disk) != 0) return FileError(errno, "cannot look at the disk");
  const auto free_bytes = static_cast<std::int64_t>(disk.f_bavail * disk.f_frsize);
  const bool has_room = reserve_ == nullptr || reserve_->Restore();
  const bool is_known = disk.f_blocks > 0;
  if (has_room && (bytes <= free_bytes || !is_known)) return absl::OkStatus();
  return NoSpace(absl::StrCat("no room for ", bytes, " bytes"));
}

absl::Status BlobFolder::Take(std::int64_t bytes) {
  if (reserve_ != nullptr && !reserve_->Restore()) return NoSpace(kPlacing);
  return space_.Take(bytes);
}

absl::Status BlobFolder::Place(const FileDescriptor& incoming, const std::string& name,
                               const std::string& sha256) {
  MutexLock lock(places_);
  const std::int64_t replaced_bytes = SizeOf(sha256);
  // Also where the blob is there already: that costs little, and repairs one that is damaged.
  if (renameat(incoming.number(), name.c_str(), directory_.number(), PathOf(sha256).c_str()) != 0) {
    return FileError(errno, kPlacing);
  }
  space_.GiveBack(replaced_bytes);
  return absl::OkStatus();
}

absl::Status BlobFolder::SynchronizePlace(const std::string& sha256) const {
  const FileDescriptor folder(
      openat(directory_.number(), FolderOf(sha256).c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (!folder.is_open()) return FileError(errno, kPlacing);
  return Synchronize(folder, kPlacing);
}

absl::Status BlobFolder::Remove(const std::string& sha256) {
  if (!IsSha256(sha256)) return absl::OkStatus();
  MutexLock lock(places_);
  const std::int64_t size = SizeOf(sha256);
  // Not synchronized: should the name come back, nothing refers to it, and the next start drops it.
  if (unlinkat(directory_.number(), PathOf(sha256).c_str(), 0) == 0) {
    space_.GiveBack(size);
    // Before others take the room that was made.
    if (reserve_ != nullptr) reserve_->Restore();
  } else if (errno != ENOENT) {
    return FileError(errno, "cannot remove a blob");
  }
  return absl::OkStatus();
}

}  // namespace ccst::server
