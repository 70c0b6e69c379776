#include "core/base/limit_error.h"

#include <vector>

#include "absl/strings/cord.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "core/base/status.h"

namespace ccst {
namespace {

constexpr char kLimitPayloadUrl[] = "ccst/passed-limit";

absl::Status WithLimit(absl::Status status, const PassedLimit& limit) {
  SetPassedLimit(limit, status);
  return status;
}

}  // namespace

absl::Status OverLimit(const PassedLimit& limit, std::string_view message) {
  return WithLimit(
      MakeError(absl::StatusCode::kInvalidArgument, ErrorReason::kLimitExceeded, message), limit);
}

absl::Status OverQuota(const PassedLimit& limit, std::string_view message) {
  return WithLimit(
      MakeError(absl::StatusCode::kResourceExhausted, ErrorReason::kQuotaExceeded, message), limit);
}

void SetPassedLimit(const PassedLimit& limit, absl::Status& status) {
  status.SetPayload(kLimitPayloadUrl,
                    absl::Cord(absl::StrCat(limit.name, " ", limit.value, " ", limit.requested)));
}

std::optional<PassedLimit> GetPassedLimit(const absl::Status& status) {
  const auto payload = status.GetPayload(kLimitPayloadUrl);
  if (!payload.has_value()) return std::nullopt;
  const std::vector<std::string> parts = absl::StrSplit(std::string(*payload), ' ');
  PassedLimit limit;
  if (parts.size() != 3 || !absl::SimpleAtoi(parts[1], &limit.value) ||
      !absl::SimpleAtoi(parts[2], &limit.requested)) {
    return std::nullopt;
  }
  limit.name = parts[0];
  return limit;
}

}  // namespace ccst
