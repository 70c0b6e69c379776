#include "server/auth/watched_file.h"

#include <filesystem>
#include <fstream>
#include <system_error>

#include <sys/stat.h>

#include "core/base/status.h"

namespace ccst::server {
namespace {

constexpr std::size_t kMaxBytes = std::size_t{1} << 20;

std::int64_t Nanoseconds(const timespec& time) {
  return std::int64_t{time.tv_sec} * 1'000'000'000 + time.tv_nsec;
}

}  // namespace

FileStamp StampOf(const std::string& path) {
  struct stat info = {};
  if (stat(path.c_str(), &info) != 0) return {};
  return {.device = info.st_dev,
          .inode = info.st_ino,
          .size = info.st_size,
          .modified = Nanoseconds(info.st_mtim),
          .changed = Nanoseconds(info.st_ctim)};
}

absl::StatusOr<std::string> ReadSmallFile(const std::string& path) {
  std::error_code error;
  std::ifstream file(path, std::ios::binary);
  if (!file.is_open() || std::filesystem::is_directory(path, error)) {
    return MakeError(absl::StatusCode::kNotFound, ErrorReason::kOptionInvalid,
                     "there is no file that can be read");
  }
  std::string text(kMaxBytes + 1, '\0');
  file.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(file.gcount()));
  if (file.bad() || text.size() > kMaxBytes) {
    return MakeError(absl::StatusCode::kNotFound, ErrorReason::kOptionInvalid,
                     "the file cannot be read or is over 1 MiB");
  }
  return text;
}

}  // namespace ccst::server
