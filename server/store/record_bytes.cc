#include "server/store/record_bytes.h"

#include "absl/strings/str_cat.h"
#include "core/base/limit_error.h"
#include "core/base/status.h"

namespace ccst::server {
namespace {

// Keys, digests and times of a row, and its places in the indexes. Migrations of the schema count
// by the same numbers.
constexpr std::int64_t kJobBytes = 2048;
constexpr std::int64_t kLabelBytes = 512;
constexpr std::int64_t kMeshBytes = 1024;

template <typename... Texts>
std::int64_t Lengths(const Texts&... texts) {
  return (static_cast<std::int64_t>(texts.size()) + ...);
}

}  // namespace

std::int64_t BytesOf(const JobRecord& job) {
  std::int64_t bytes =
      kJobBytes + Lengths(job.owner, job.request_id, job.display_name, job.definition, job.outcome);
  // A label stands in its row and in an index.
  for (const auto& [name, value] : job.labels) bytes += kLabelBytes + 2 * Lengths(name, value);
  return bytes;
}

std::int64_t BytesOf(const MeshRecord& mesh) {
  return kMeshBytes + Lengths(mesh.owner, mesh.display_name, mesh.facts);
}

absl::Status CheckRecordRoom(Store& store, const std::string& owner, std::int64_t bytes,
                             const RecordLimits& limits) {
  std::int64_t used = 0;
  CCST_ASSIGN_OR_RETURN(used, store.RecordBytes(owner));
  const PassedLimit passed = {"max_record_bytes_per_caller", limits.max_owner_bytes, used + bytes};
  if (bytes > limits.max_owner_bytes) {
    return OverLimit(
        passed,
        absl::StrCat("the record may have ", bytes, " bytes, over max_record_bytes_per_caller, ",
                     limits.max_owner_bytes, "; ask for fewer iterations or send fewer labels"));
  }
  if (bytes > limits.max_owner_bytes - used) {
    return OverQuota(
        passed, absl::StrCat("the records of your jobs and meshes have ", used, " bytes, and ",
                             bytes, " more do not fit within max_record_bytes_per_caller, ",
                             limits.max_owner_bytes,
                             "; delete jobs that have ended or meshes, or wait until some expire"));
  }
  CCST_ASSIGN_OR_RETURN(used, store.AllRecordBytes());
  if (bytes <= limits.max_bytes - used) return absl::OkStatus();
  return MakeError(absl::StatusCode::kResourceExhausted, ErrorReason::kStorageFull,
                   absl::StrCat("the server keeps ", used, " bytes of records, of at most ",
                                limits.max_bytes, ", and ", bytes,
                                " more do not fit; delete jobs or meshes, or wait until some "
                                "expire"));
}

}  // namespace ccst::server
