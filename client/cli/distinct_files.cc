#include "client/cli/distinct_files.h"

#include <filesystem>
#include <optional>
#include <string>
#include <system_error>

#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <unistd.h>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"

namespace ccst::cli {
namespace {

namespace fs = std::filesystem;

constexpr char kStandardStream[] = "-";

// What a path leads to: a file that exists, or a name in a folder where one will be.
struct Place {
  dev_t device = 0;
  ino_t inode = 0;
  std::string name = {};     // In the folder; empty for a file that exists.
  bool is_null = false;      // /dev/null.
  bool keeps_bytes = false;  // What is written to it can be read again.

  bool IsSame(const Place& other) const {
    return device == other.device && inode == other.inode && name == other.name;
  }
};

// `stream` is what `-` stands for. Empty where nothing can be said, as of a folder that is missing.
std::optional<Place> PlaceOf(const std::string& path, int stream) {
  struct stat info = {};
  const bool exists =
      path == kStandardStream ? fstat(stream, &info) == 0 : stat(path.c_str(), &info) == 0;
  if (exists) {
    const bool is_null = S_ISCHR(info.st_mode) && info.st_rdev == makedev(1, 3);
    return Place{.device = info.st_dev,
                 .inode = info.st_ino,
                 .is_null = is_null,
                 .keeps_bytes = S_ISREG(info.st_mode) || S_ISBLK(info.st_mode)};
  }
  if (path == kStandardStream) return std::nullopt;
  const fs::path file(path);
  const fs::path folder = file.has_parent_path() ? file.parent_path() : fs::path(".");
  if (stat(folder.c_str(), &info) != 0) return std::nullopt;
  return Place{.device = info.st_dev, .inode = info.st_ino, .name = file.filename().string()};
}

bool HasExtension(const fs::path& path, const char* extension) {
  return absl::AsciiStrToLower(path.extension().string()) == extension;
}

// True when `output` is a file that `input` may take its numbers from: glTF's lie beside it.
bool MayBeBufferOf(const std::string& output, const std::string& input) {
  if (!HasExtension(input, ".gltf")) return false;
  std::error_code error;
  const fs::path file = fs::canonical(output, error);
  if (error || !HasExtension(file, ".bin")) return false;
  const fs::path mesh = fs::canonical(input, error);
  return !error && file.parent_path() == mesh.parent_path();
}

std::string Shown(const NamedFile& file) {
  return file.path == kStandardStream ? file.name : absl::StrCat(file.name, " ", file.path);
}

absl::Status CheckOutput(const NamedFile& output, const NamedFile& input) {
  if (output.path.empty() || input.path.empty()) return absl::OkStatus();
  const auto written = PlaceOf(output.path, STDOUT_FILENO);
  const auto read = PlaceOf(input.path, STDIN_FILENO);
  const bool is_same =
      written.has_value() && read.has_value() && read->keeps_bytes && written->IsSame(*read);
  if (is_same) {
    return absl::InvalidArgumentError(absl::StrCat(Shown(output), " would overwrite ", Shown(input),
                                                   ", which is read; name another file"));
  }
  if (MayBeBufferOf(output.path, input.path)) {
    return absl::InvalidArgumentError(
        absl::StrCat(Shown(output), " would overwrite what may be a buffer of ", Shown(input),
                     ", which is read; name another file"));
  }
  return absl::OkStatus();
}

absl::Status CheckOutputs(const NamedFile& one, const NamedFile& other) {
  if (one.path.empty() || other.path.empty()) return absl::OkStatus();
  if (one.path == kStandardStream && other.path == kStandardStream) {
    return absl::InvalidArgumentError("standard output can take one output only");
  }
  const auto first = PlaceOf(one.path, STDOUT_FILENO);
  const auto second = PlaceOf(other.path, STDOUT_FILENO);
  if (!first.has_value() || !second.has_value() || first->is_null || !first->IsSame(*second)) {
    return absl::OkStatus();
  }
  return absl::InvalidArgumentError(absl::StrCat(Shown(one), " and ", Shown(other),
                                                 " are one file, which can take one output only"));
}

}  // namespace

absl::Status CheckDistinct(const std::vector<NamedFile>& outputs,
                           const std::vector<NamedFile>& inputs) {
  absl::Status status;
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    for (std::size_t j = 0; status.ok() && j < i; ++j) {
      status = CheckOutputs(outputs[j], outputs[i]);
    }
    for (std::size_t j = 0; status.ok() && j < inputs.size(); ++j) {
      status = CheckOutput(outputs[i], inputs[j]);
    }
  }
  return status;
}

}  // namespace ccst::cli
