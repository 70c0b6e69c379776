#include "server/store/file_blobs.h"

#include <algorithm>
#include <cerrno>
#include <cstdint>
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
constexpr std::int64_t kPieceBytes = std::int64_t{1} << 20;

}  // namespace

class FileBlob : public Blob {
 public:
  FileBlob(FileDescriptor file, std::int64_t size_bytes, std::string sha256,
           std::shared_ptr<KnownBlobs> known)
      : file_(std::move(file)),
        size_bytes_(size_bytes),
        sha256_(std::move(sha256)),
        known_(std::move(known)) {}

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

  void Doubt() const override { known_->Forget(sha256_); }

  const FileDescriptor& file() const { return file_; }

 private:
  const FileDescriptor file_;
  const std::int64_t size_bytes_;
  const std::string sha256_;
  const std::shared_ptr<KnownBlobs> known_;
};

namespace {

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
                                                           std::int64_t max_bytes,
                                                           SpaceReserve* reserve) {
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
      new FileBlobs(std::move(blobs), std::move(incoming), max_bytes, reserve));
  std::vector<std::string> digests;
  CCST_ASSIGN_OR_RETURN(digests, opened->List());
  for (const std::string& sha256 : digests) {
    opened->blobs_.Count(opened->blobs_.SizeOf(sha256));
  }
  return opened;
}

absl::StatusOr<std::unique_ptr<BlobWriter>> FileBlobs::NewBlob() {
  return FileBlobWriter::Create(blobs_, incoming_, absl::StrCat(next_name_++));
}

absl::StatusOr<std::shared_ptr<const FileBlob>> FileBlobs::OpenFile(
    const std::string& sha256) const {
  const auto missing = [&sha256] {
    return MakeError(absl::StatusCode::kNotFound, ErrorReason::kNotFound,
                     "no blob " + sha256 + " is stored");
  };
  if (!IsSha256(sha256)) return missing();
  FileDescriptor file(openat(blobs_.directory().number(), BlobFolder::PathOf(sha256).c_str(),
                             O_RDONLY | O_CLOEXEC));
  if (!file.is_open()) return errno == ENOENT ? missing() : FileError(errno, kReading);
  struct stat facts = {};
  if (fstat(file.number(), &facts) != 0) return FileError(errno, kReading);
  return std::make_shared<FileBlob>(std::move(file), facts.st_size, sha256, blobs_.known());
}

absl::StatusOr<std::shared_ptr<const Blob>> FileBlobs::Open(const std::string& sha256) const {
  return OpenFile(sha256);
}

absl::Status FileBlobs::Check(const std::string& sha256) const {
  std::shared_ptr<const FileBlob> blob;
  CCST_ASSIGN_OR_RETURN(blob, OpenFile(sha256));
  KnownBlobs& known = *blobs_.known();
  if (known.Contains(sha256, blob->file())) return absl::OkStatus();
  CheckedReader reader(blob, sha256);
  std::string piece;
  do {
    piece.resize(
        static_cast<std::size_t>(std::min(kPieceBytes, reader.size_bytes() - reader.offset())));
    CCST_RETURN_IF_ERROR(reader.Next(piece));
  } while (!reader.at_end());
  known.Add(sha256, blob->file());
  return absl::OkStatus();
}

absl::StatusOr<std::vector<std::string>> FileBlobs::List() const {
  std::vector<std::string> digests;
  for (int i = 0; i < kFolderCount; ++i) {
    std::vector<std::string> names;
    CCST_ASSIGN_OR_RETURN(names, NamesIn(blobs_.directory(), FolderOf(i).c_str()));
    for (std::string& name : names) {
      if (IsSha256(name)) digests.push_back(std::move(name));
    }
  }
  return digests;
}

}  // namespace ccst::server
