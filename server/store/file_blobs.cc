#include "server/store/file_blobs.h"

#include <cerrno>
#include <utility>

#include <dirent.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "absl/strings/str_cat.h"
#include "core/base/sha256.h"
#include "core/base/status.h"
#include "server/store/file_blob_writer.h"
#include "server/store/storage_error.h"

namespace ccst::server {
namespace {

// By the first two digits.
constexpr int kFolderCount = 256;
constexpr char kReading[] = "cannot read a blob";

class FileBlob : public Blob {
 public:
  FileBlob(FileDescriptor file, std::int64_t size_bytes)
      : file_(std::move(file)), size_bytes_(size_bytes) {}

  std::int64_t size_bytes() const override { return size_bytes_; }

  absl::Status Read(std::int64_t offset, std::span<char> out) const override {
    while (!out.empty()) {
      const ssize_t count = pread(file_.number(), out.data(), out.size(), offset);
      if (count < 0 && errno == EINTR) continue;
      if (count < 0) return FileError(errno, kReading);
      if (count == 0) {
        return MakeError(
            absl::StatusCode::kInternal, ErrorReason::kStorageFailed,
            absl::StrCat("a blob ends at byte ", offset, ", before what was asked for"));
      }
      offset += count;
      out = out.subspan(static_cast<std::size_t>(count));
    }
    return absl::OkStatus();
  }

 private:
  const FileDescriptor file_;
  const std::int64_t size_bytes_;
};

// The names in a directory but for "." and "..".
absl::StatusOr<std::vector<std::string>> NamesIn(const FileDescriptor& parent, const char* name) {
  FileDescriptor directory(openat(parent.number(), name, O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (!directory.is_open()) return FileError(errno, "cannot list the blobs");
  const std::unique_ptr<DIR, int (*)(DIR*)> entries(fdopendir(directory.number()), &closedir);
  if (entries == nullptr) return FileError(errno, "cannot list the blobs");
  directory.Release();
  std::vector<std::string> names;
  errno = 0;
  while (const dirent* entry = readdir(entries.get())) {
    const std::string_view text = entry->d_name;
    if (text != "." && text != "..") names.emplace_back(text);
  }
  if (errno != 0) return FileError(errno, "cannot list the blobs");
  return names;
}

std::string FolderOf(int index) { return absl::StrCat(absl::Hex(index, absl::kZeroPad2)); }

}  // namespace

absl::StatusOr<std::unique_ptr<FileBlobs>> FileBlobs::Open(const FileDescriptor& directory,
                                                           std::int64_t max_bytes) {
  FileDescriptor blobs;
  FileDescriptor incoming;
  CCST_ASSIGN_OR_RETURN(blobs, OpenSubdirectory(directory, "blobs"));
  CCST_ASSIGN_OR_RETURN(incoming, OpenSubdirectory(directory, "incoming"));
  // All folders at once: a commit then need not wonder whether its folder lasts.
  for (int i = 0; i < kFolderCount; ++i) {
    CCST_RETURN_IF_ERROR(OpenSubdirectory(blobs, FolderOf(i).c_str()).status());
  }
  CCST_RETURN_IF_ERROR(Synchronize(blobs, "cannot make the folders of the blobs"));
  std::vector<std::string> left_over;
  CCST_ASSIGN_OR_RETURN(left_over, NamesIn(incoming, "."));
  for (const std::string& name : left_over) {
    if (unlinkat(incoming.number(), name.c_str(), 0) != 0) {
      return FileError(errno, "cannot remove an unfinished blob");
    }
  }
  std::unique_ptr<FileBlobs> opened(
      new FileBlobs(std::move(blobs), std::move(incoming), max_bytes));
  std::vector<std::string> digests;
  CCST_ASSIGN_OR_RETURN(digests, opened->List());
  for (const std::string& sha256 : digests) opened->space_.Count(opened->SizeOf(sha256));
  return opened;
}

absl::StatusOr<std::unique_ptr<BlobWriter>> FileBlobs::NewBlob() {
  return FileBlobWriter::Create(blobs_, incoming_, absl::StrCat(next_name_++), space_);
}

absl::StatusOr<std::shared_ptr<const Blob>> FileBlobs::Open(const std::string& sha256) const {
  const auto missing = [&sha256] {
    return MakeError(absl::StatusCode::kNotFound, ErrorReason::kNotFound,
                     "no blob " + sha256 + " is stored");
  };
  if (!IsSha256(sha256)) return missing();
  FileDescriptor file(openat(blobs_.number(), BlobPath(sha256).c_str(), O_RDONLY | O_CLOEXEC));
  if (!file.is_open()) return errno == ENOENT ? missing() : FileError(errno, kReading);
  struct stat facts = {};
  if (fstat(file.number(), &facts) != 0) return FileError(errno, kReading);
  return std::make_shared<FileBlob>(std::move(file), facts.st_size);
}

std::int64_t FileBlobs::SizeOf(const std::string& sha256) const {
  struct stat facts = {};
  const bool found =
      IsSha256(sha256) && fstatat(blobs_.number(), BlobPath(sha256).c_str(), &facts, 0) == 0;
  return found ? facts.st_size : 0;
}

bool FileBlobs::Contains(const std::string& sha256) const {
  return IsSha256(sha256) && faccessat(blobs_.number(), BlobPath(sha256).c_str(), F_OK, 0) == 0;
}

absl::Status FileBlobs::Remove(const std::string& sha256) {
  const std::int64_t size = SizeOf(sha256);
  // Not synchronized: should the name come back, nothing refers to it, and the next start drops it.
  if (IsSha256(sha256) && unlinkat(blobs_.number(), BlobPath(sha256).c_str(), 0) != 0 &&
      errno != ENOENT) {
    return FileError(errno, "cannot remove a blob");
  }
  space_.GiveBack(size);
  return absl::OkStatus();
}

absl::StatusOr<std::vector<std::string>> FileBlobs::List() const {
  std::vector<std::string> digests;
  for (int i = 0; i < kFolderCount; ++i) {
    std::vector<std::string> names;
    CCST_ASSIGN_OR_RETURN(names, NamesIn(blobs_, FolderOf(i).c_str()));
    for (std::string& name : names) {
      if (IsSha256(name)) digests.push_back(std::move(name));
    }
  }
  return digests;
}

}  // namespace ccst::server
