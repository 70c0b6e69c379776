#include "server/store/file_blob_writer.h"

#include <cerrno>
#include <cstdio>
#include <utility>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "absl/strings/str_cat.h"
#include "core/base/status.h"
#include "server/store/storage_error.h"

namespace ccst::server {
namespace {

constexpr char kWriting[] = "cannot write a blob";

std::string FolderPath(const std::string& sha256) { return sha256.substr(0, 2); }

}  // namespace

std::string BlobPath(const std::string& sha256) {
  return absl::StrCat(FolderPath(sha256), "/", sha256);
}

FileBlobWriter::FileBlobWriter(const FileDescriptor& blobs, const FileDescriptor& incoming,
                               std::string name, FileDescriptor file, BlobSpace& space)
    : blobs_(blobs),
      incoming_(incoming),
      name_(std::move(name)),
      file_(std::move(file)),
      space_(space) {}

absl::StatusOr<std::unique_ptr<BlobWriter>> FileBlobWriter::Create(const FileDescriptor& blobs,
                                                                   const FileDescriptor& incoming,
                                                                   std::string name,
                                                                   BlobSpace& space) {
  FileDescriptor file(openat(incoming.number(), name.c_str(),
                             O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, S_IRUSR | S_IWUSR));
  if (!file.is_open()) return FileError(errno, kWriting);
  return std::unique_ptr<BlobWriter>(
      new FileBlobWriter(blobs, incoming, std::move(name), std::move(file), space));
}

FileBlobWriter::~FileBlobWriter() { Discard(); }

absl::Status FileBlobWriter::Append(std::string_view bytes) {
  CCST_RETURN_IF_ERROR(status_);
  const auto size = static_cast<std::int64_t>(bytes.size());
  if (absl::Status room = space_.Take(size); !room.ok()) return Fail(std::move(room));
  hash_.Add(bytes);
  size_bytes_ += size;
  while (!bytes.empty()) {
    const ssize_t count = write(file_.number(), bytes.data(), bytes.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return Fail(FileError(errno, kWriting));
    bytes.remove_prefix(static_cast<std::size_t>(count));
  }
  return absl::OkStatus();
}

const std::string& FileBlobWriter::Seal() {
  if (sha256_.empty()) sha256_ = hash_.Finish();
  return sha256_;
}

absl::Status FileBlobWriter::Commit() {
  CCST_RETURN_IF_ERROR(status_);
  const std::string& sha256 = Seal();
  if (absl::Status status = Synchronize(file_, kWriting); !status.ok()) return Fail(status);
  struct stat replaced = {};
  const bool is_new = fstatat(blobs_.number(), BlobPath(sha256).c_str(), &replaced, 0) != 0;
  // Also where the blob is there already: that costs little, and repairs one that is damaged.
  if (renameat(incoming_.number(), name_.c_str(), blobs_.number(), BlobPath(sha256).c_str()) != 0) {
    return Fail(FileError(errno, kWriting));
  }
  file_.Close();
  if (!is_new) space_.GiveBack(replaced.st_size);
  const FileDescriptor folder(
      openat(blobs_.number(), FolderPath(sha256).c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (!folder.is_open()) return FileError(errno, kWriting);
  return Synchronize(folder, kWriting);
}

absl::Status FileBlobWriter::Fail(absl::Status status) {
  Discard();
  status_ = std::move(status);
  return status_;
}

void FileBlobWriter::Discard() {
  // At once, as others may be short of the space.
  if (!file_.is_open()) return;
  unlinkat(incoming_.number(), name_.c_str(), 0);
  file_.Close();
  space_.GiveBack(size_bytes_);
}

}  // namespace ccst::server
