#include "core/io/whole_file.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <system_error>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "absl/cleanup/cleanup.h"
#include "absl/strings/str_cat.h"
#include "core/io/io_errors.h"

namespace ccst::io {

absl::Status SystemError(int error_number, const std::string& path, const char* what) {
  absl::StatusCode code = absl::ErrnoToStatusCode(error_number);
  // A directory where a file was expected is the caller's slip, not a state of the system.
  if (error_number == EISDIR || error_number == ENOTDIR) code = absl::StatusCode::kInvalidArgument;
  return absl::Status(
      code, absl::StrCat(path, ": ", what, ": ", std::generic_category().message(error_number)));
}

absl::StatusOr<std::string> ReadWholeFile(const std::string& path, std::int64_t max_bytes) {
  const int file = open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0) return SystemError(errno, path, "cannot open");
  const auto close_file = absl::MakeCleanup([file] { close(file); });
  struct stat info = {};
  if (fstat(file, &info) != 0) return SystemError(errno, path, "cannot examine");
  const auto too_large = [&] {
    return OverLimit(absl::StrCat(path, ": more than ", max_bytes, " bytes, the most accepted"));
  };
  if (S_ISREG(info.st_mode) && info.st_size > max_bytes) return too_large();

  // The size is a hint only: pipes have none, and files grow.
  constexpr std::size_t kStep = std::size_t{1} << 16;
  std::string bytes;
  bytes.resize(S_ISREG(info.st_mode) ? static_cast<std::size_t>(info.st_size) + 1 : kStep);
  std::size_t size = 0;
  while (true) {
    if (size == bytes.size()) bytes.resize(bytes.size() + std::max(kStep, bytes.size() / 2));
    const ssize_t got = read(file, bytes.data() + size, bytes.size() - size);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return SystemError(errno, path, "cannot read");
    if (got == 0) break;
    size += static_cast<std::size_t>(got);
    if (static_cast<std::int64_t>(size) > max_bytes) return too_large();
  }
  bytes.resize(size);
  return bytes;
}

}  // namespace ccst::io
