#include "client/cli/errors.h"

#include <cstdio>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "client/lib/grpc_error.h"
#include "core/base/printable_text.h"
#include "core/base/status.h"

namespace ccst::cli {
namespace {

// Longer ones say no more to people.
constexpr std::size_t kMaxErrorBytes = 4096;

}  // namespace

std::string ErrorText(const absl::Status& status, const std::string& server) {
  const std::string message(status.message());
  if (const auto delay = RetryDelaySeconds(status)) {
    return absl::StrFormat("%s; try again in %.3g s", message, *delay);
  }
  const auto reason = GetErrorReason(status);
  if (absl::IsUnavailable(status) ||
      (absl::IsDeadlineExceeded(status) && reason != ErrorReason::kTimeLimitExceeded)) {
    return absl::StrCat("cannot reach the server at ", server, " (", message,
                        "); start one with ccst-server, name another with --server, or compute "
                        "here with --local");
  }
  if (absl::IsUnauthenticated(status)) {
    return absl::StrCat(message, "; give a token with --token-file or CCST_TOKEN");
  }
  const bool is_too_big = absl::IsResourceExhausted(status) && !reason.has_value();
  if (is_too_big ||
      (reason == ErrorReason::kLimitExceeded && absl::StrContains(message, "bytes"))) {
    return absl::StrCat(message, "; a smaller upload with --quantization-bits, or --local, may do");
  }
  return message.empty() ? absl::StatusCodeToString(status.code()) : message;
}

void PrintError(const absl::Status& status, const std::string& server) {
  // Texts of servers and names of files may hold anything.
  std::fprintf(stderr, "ccst: %s\n",
               PrintableExcerpt(ErrorText(status, server), kMaxErrorBytes).c_str());
}

}  // namespace ccst::cli
