#pragma once

#include <cstdint>
#include <string>

#include "absl/status/status.h"
#include "core/base/status.h"

namespace ccst::server::internal {

/// `format` of the messages of ccst.store.v1 that are stored by themselves.
inline constexpr std::uint32_t kFormat = 1;

/// DATA_LOSS STORAGE_FAILED: the bytes of `what` are not such a message.
inline absl::Status DamagedRecord(const std::string& what) {
  return MakeError(absl::StatusCode::kDataLoss, ErrorReason::kStorageFailed,
                   "the stored " + what + " damaged");
}

/// Reads `message` from `bytes`. Errors as DamagedRecord().
template <typename Message>
absl::Status ParseStored(const std::string& bytes, const std::string& what, Message& message) {
  const bool is_whole = message.ParseFromString(bytes) && message.format() == kFormat;
  return is_whole ? absl::OkStatus() : DamagedRecord(what);
}

}  // namespace ccst::server::internal
