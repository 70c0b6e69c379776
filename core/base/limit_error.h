#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "absl/status/status.h"

namespace ccst {

/// A limit that was passed; travels as a payload of absl::Status and becomes a `LimitViolation` on
/// the wire.
struct PassedLimit {
  std::string name;            ///< A field of `ServerLimits`, for example `max_sample_count`.
  std::int64_t value = 0;      ///< What the limit is.
  std::int64_t requested = 0;  ///< What was asked for, together with what is held already.
};

/// INVALID_ARGUMENT LIMIT_EXCEEDED: never fits, so that asking again is in vain.
absl::Status OverLimit(const PassedLimit& limit, std::string_view message);

/// RESOURCE_EXHAUSTED QUOTA_EXCEEDED: fits once the caller has given back some of what it holds.
/// The only place that makes this reason.
absl::Status OverQuota(const PassedLimit& limit, std::string_view message);

/// Lets `status`, which is not OK, name the limit that it is about.
void SetPassedLimit(const PassedLimit& limit, absl::Status& status);

/// The limit inside `status`; empty when it carries none.
std::optional<PassedLimit> GetPassedLimit(const absl::Status& status);

}  // namespace ccst
