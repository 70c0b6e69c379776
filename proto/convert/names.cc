#include "proto/convert/names.h"

#include <algorithm>

#include "core/base/sha256.h"

namespace ccst {
namespace {

constexpr std::string_view kMeshes = "meshes/";
constexpr std::string_view kJobs = "jobs/";
constexpr std::size_t kMaxJobId = 64;

}  // namespace

std::int64_t CountCharacters(std::string_view text) {
  return std::count_if(text.begin(), text.end(),
                       [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U; });
}

void CheckText(const std::string& text, std::int64_t longest, const std::string& path,
               Violations& violations) {
  if (CountCharacters(text) <= longest) return;
  violations.Add(path, "must have at most " + std::to_string(longest) + " characters",
                 ErrorReason::kRequestInvalid);
}

std::string MeshName(std::string_view sha256) { return std::string(kMeshes) + std::string(sha256); }

std::string Sha256OfMeshName(const std::string& name, const std::string& path,
                             Violations& violations) {
  if (name.starts_with(kMeshes) && IsSha256(std::string_view(name).substr(kMeshes.size()))) {
    return name.substr(kMeshes.size());
  }
  violations.Add(path,
                 "must be meshes/ and the SHA-256 of the mesh in 64 lowercase hexadecimal digits",
                 ErrorReason::kRequestInvalid);
  return {};
}

std::string JobName(std::string_view id) { return std::string(kJobs) + std::string(id); }

std::string IdOfJobName(const std::string& name, const std::string& path, Violations& violations) {
  if (name.starts_with(kJobs) && name.size() > kJobs.size() &&
      name.size() <= kJobs.size() + kMaxJobId) {
    return name.substr(kJobs.size());
  }
  violations.Add(path, "must be jobs/ and the id of a job", ErrorReason::kRequestInvalid);
  return {};
}

}  // namespace ccst
