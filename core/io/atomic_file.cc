#include "core/io/atomic_file.h"

#include <atomic>
#include <cerrno>
#include <cstdint>
#include <cstdlib>
#include <memory>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "absl/cleanup/cleanup.h"
#include "absl/strings/str_cat.h"
#include "core/base/status.h"
#include "core/io/whole_file.h"

namespace ccst {
namespace {

absl::Status WriteAll(int file, std::string_view contents, const std::string& path) {
  while (!contents.empty()) {
    const ssize_t written = write(file, contents.data(), contents.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return io::SystemError(errno, path, "cannot write");
    contents.remove_prefix(static_cast<std::size_t>(written));
  }
  return absl::OkStatus();
}

absl::Status WriteInPlace(const std::string& path, std::string_view contents) {
  const int file = open(path.c_str(), O_WRONLY | O_CLOEXEC);
  if (file < 0) return io::SystemError(errno, path, "cannot open for writing");
  const absl::Status status = WriteAll(file, contents, path);
  if (close(file) != 0 && status.ok()) return io::SystemError(errno, path, "cannot write");
  return status;
}

// Opens a new file beside `path`, whose name it sets.
absl::StatusOr<int> OpenBeside(const std::string& path, std::string& name) {
  static std::atomic<std::uint32_t> counter = 0;
  constexpr int kAttempts = 100;
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    name = absl::StrCat(path, ".", getpid(), "-", counter.fetch_add(1), ".tmp");
    const int file = open(name.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (file >= 0) return file;
    if (errno != EEXIST) return io::SystemError(errno, path, "cannot create a file beside it");
  }
  return io::SystemError(EEXIST, path, "cannot create a file beside it");
}

// Makes the rename itself durable. Not every file system can; the file is whole either way.
void FlushDirectoryOf(const std::string& path) {
  const std::size_t slash = path.rfind('/');
  const std::string directory =
      slash == std::string::npos ? std::string(".") : path.substr(0, slash + 1);
  const int file = open(directory.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (file < 0) return;
  fsync(file);
  close(file);
}

// `path` with its symbolic links followed, so that they survive the rename.
std::string Resolved(const std::string& path) {
  const std::unique_ptr<char, decltype(&std::free)> real(realpath(path.c_str(), nullptr),
                                                         &std::free);
  return real != nullptr ? std::string(real.get()) : path;
}

}  // namespace

absl::Status WriteFileAtomically(const std::string& path, std::string_view contents) {
  if (path == "-") return WriteAll(STDOUT_FILENO, contents, "standard output");
  struct stat info = {};
  const bool exists = stat(path.c_str(), &info) == 0;
  if (exists && S_ISDIR(info.st_mode)) return io::SystemError(EISDIR, path, "cannot write");
  if (exists && !S_ISREG(info.st_mode)) return WriteInPlace(path, contents);

  const std::string target = Resolved(path);
  std::string temporary;
  CCST_ASSIGN_OR_RETURN(const int file, OpenBeside(target, temporary));
  auto remove_temporary = absl::MakeCleanup([&temporary] { unlink(temporary.c_str()); });
  absl::Status status = WriteAll(file, contents, path);
  if (status.ok() && exists && fchmod(file, info.st_mode & 07777) != 0) {
    status = io::SystemError(errno, path, "cannot keep its permissions");
  }
  if (status.ok() && fsync(file) != 0) status = io::SystemError(errno, path, "cannot write");
  if (close(file) != 0 && status.ok()) status = io::SystemError(errno, path, "cannot write");
  CCST_RETURN_IF_ERROR(status);
  if (rename(temporary.c_str(), target.c_str()) != 0) {
    return io::SystemError(errno, path, "cannot rename the finished file");
  }
  std::move(remove_temporary).Cancel();
  FlushDirectoryOf(target);
  return absl::OkStatus();
}

}  // namespace ccst
