#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "absl/status/status.h"
#include "absl/status/statusor.h"

namespace ccst::server {

/// An open file or directory; closed in the end.
class FileDescriptor {
 public:
  explicit FileDescriptor(int number = -1) : number_(number) {}
  ~FileDescriptor() { Close(); }
  FileDescriptor(FileDescriptor&& other) noexcept : number_(other.number_) { other.number_ = -1; }
  FileDescriptor& operator=(FileDescriptor&& other) noexcept;

  int number() const { return number_; }
  bool is_open() const { return number_ >= 0; }
  void Close();
  /// Leaves closing it to the caller.
  int Release();

 private:
  int number_;
};

/// Makes what is missing of `path`, for its owner alone, durably, and opens the directory.
/// @errors RESOURCE_EXHAUSTED STORAGE_FULL | INTERNAL STORAGE_FAILED
absl::StatusOr<FileDescriptor> OpenDirectory(const std::string& path);

/// Makes the directory `name` in `parent` where it is missing and opens it; it lasts once `parent`
/// is synchronized. Errors as OpenDirectory().
absl::StatusOr<FileDescriptor> OpenSubdirectory(const FileDescriptor& parent, const char* name);

/// Makes the file `name` in `directory` where it is missing and locks it until it is closed or the
/// process is gone. Holds against other processes and against another lock of this one.
/// @errors FAILED_PRECONDITION STORAGE_FAILED when it is locked | as OpenDirectory()
absl::StatusOr<FileDescriptor> LockFile(const FileDescriptor& directory, const char* name);

/// Makes what was written to a file, or the names in a directory, survive a loss of power.
absl::Status Synchronize(const FileDescriptor& file, std::string_view what);

}  // namespace ccst::server
