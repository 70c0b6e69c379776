#include "proto/convert/error_reasons.h"

namespace ccst {

std::optional<ErrorReason> FindErrorReason(std::string_view name) {
  for (int i = 0;; ++i) {
    const auto reason = static_cast<ErrorReason>(i);
    const std::string_view candidate = ErrorReasonName(reason);
    if (candidate == "UNKNOWN") return std::nullopt;
    if (candidate == name) return reason;
  }
}

}  // namespace ccst
