#pragma once

#include <cstdint>
#include <string>

#include "absl/status/status.h"
#include "server/store/records.h"
#include "server/store/store.h"

namespace ccst::server {

/// What a record takes, about: its text, and a share of the rows and indexes that hold it. Of a job
/// its labels too, but not its history, which counts as it is.
std::int64_t BytesOf(const JobRecord& job);
std::int64_t BytesOf(const MeshRecord& mesh);

/// How many bytes records and histories may have.
struct RecordLimits {
  std::int64_t max_bytes = std::int64_t{16} << 30;       ///< Of all owners.
  std::int64_t max_owner_bytes = std::int64_t{4} << 30;  ///< Of one.
};

/// Whether `bytes` more of the owner's fit. Calls at once may each find the same room, so that a
/// few records can be over the limit.
/// @errors RESOURCE_EXHAUSTED QUOTA_EXCEEDED over the owner's | STORAGE_FULL over that of all
///       | INVALID_ARGUMENT LIMIT_EXCEEDED over the owner's by themselves | those of Store
absl::Status CheckRecordRoom(Store& store, const std::string& owner, std::int64_t bytes,
                             const RecordLimits& limits);

}  // namespace ccst::server
