#include "server/store/files.h"

#include <cerrno>
#include <filesystem>
#include <utility>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/base/status.h"
#include "server/store/storage_error.h"

namespace ccst::server {
namespace {

constexpr int kOpenDirectory = O_RDONLY | O_DIRECTORY | O_CLOEXEC;

// The folder that holds `path`.
std::filesystem::path ParentOf(const std::filesystem::path& path) {
  const std::filesystem::path parent = path.parent_path();
  return parent.empty() ? "." : parent;
}

}  // namespace

FileDescriptor& FileDescriptor::operator=(FileDescriptor&& other) noexcept {
  if (this != &other) {
    Close();
    number_ = std::exchange(other.number_, -1);
  }
  return *this;
}

void FileDescriptor::Close() {
  if (is_open()) close(Release());
}

int FileDescriptor::Release() { return std::exchange(number_, -1); }

absl::StatusOr<FileDescriptor> OpenDirectory(const std::string& path) {
  FileDescriptor directory(open(path.c_str(), kOpenDirectory));
  if (directory.is_open()) return directory;
  if (errno != ENOENT || path.empty()) return FileError(errno, "cannot open the directory");

  std::filesystem::path last = path;
  if (!last.has_filename()) last = last.parent_path();
  FileDescriptor parent;
  CCST_ASSIGN_OR_RETURN(parent, OpenDirectory(ParentOf(last)));
  CCST_ASSIGN_OR_RETURN(directory, OpenSubdirectory(parent, last.filename().c_str()));
  CCST_RETURN_IF_ERROR(Synchronize(parent, "cannot make the directory"));
  return directory;
}

absl::StatusOr<FileDescriptor> OpenSubdirectory(const FileDescriptor& parent, const char* name) {
  if (mkdirat(parent.number(), name, S_IRWXU) != 0 && errno != EEXIST) {
    return FileError(errno, "cannot make a directory");
  }
  FileDescriptor directory(openat(parent.number(), name, kOpenDirectory));
  if (!directory.is_open()) return FileError(errno, "cannot open a directory");
  return directory;
}

absl::StatusOr<FileDescriptor> LockFile(const FileDescriptor& directory, const char* name) {
  FileDescriptor file(
      openat(directory.number(), name, O_RDWR | O_CREAT | O_CLOEXEC, S_IRUSR | S_IWUSR));
  if (!file.is_open()) return FileError(errno, "cannot open the lock");
  if (flock(file.number(), LOCK_EX | LOCK_NB) != 0) {
    if (errno != EWOULDBLOCK) return FileError(errno, "cannot lock the directory");
    return MakeError(absl::StatusCode::kFailedPrecondition, ErrorReason::kStorageFailed,
                     "another server has the directory open: stop it or use another directory");
  }
  return file;
}

absl::Status Synchronize(const FileDescriptor& file, std::string_view what) {
  if (fsync(file.number()) != 0) return FileError(errno, what);
  return absl::OkStatus();
}

}  // namespace ccst::server
