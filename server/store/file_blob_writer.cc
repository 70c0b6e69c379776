#include "server/store/file_blob_writer.h"

#include <cerrno>
#include <utility>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/base/status.h"
#include "server/store/storage_error.h"

namespace ccst::server {
namespace {

constexpr char kWriting[] = "cannot write a blob";

}  // namespace

FileBlobWriter::FileBlobWriter(BlobFolder& blobs, const FileDescriptor& incoming, std::string name,
                               FileDescriptor file)
    : blobs_(blobs), incoming_(incoming), name_(std::move(name)), file_(std::move(file)) {}

absl::StatusOr<std::unique_ptr<BlobWriter>> FileBlobWriter::Create(BlobFolder& blobs,
                                                                   const FileDescriptor& incoming,
                                                                   std::string name) {
  FileDescriptor file(openat(incoming.number(), name.c_str(),
                             O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, S_IRUSR | S_IWUSR));
  if (!file.is_open()) return FileError(errno, kWriting);
  return std::unique_ptr<BlobWriter>(
      new FileBlobWriter(blobs, incoming, std::move(name), std::move(file)));
}

FileBlobWriter::~FileBlobWriter() { Discard(); }

absl::Status FileBlobWriter::Append(std::string_view bytes) {
  CCST_RETURN_IF_ERROR(status_);
  const auto size = static_cast<std::int64_t>(bytes.size());
  if (absl::Status room = blobs_.Take(size); !room.ok()) return Fail(std::move(room));
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
  if (absl::Status status = blobs_.Place(incoming_, name_, sha256); !status.ok()) {
    return Fail(status);
  }
  blobs_.known()->Add(sha256, file_);
  file_.Close();
  return blobs_.SynchronizePlace(sha256);
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
  blobs_.GiveBack(size_bytes_);
}

}  // namespace ccst::server
