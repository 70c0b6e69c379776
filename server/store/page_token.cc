#include "server/store/page_token.h"

#include <cstdint>

#include "absl/strings/escaping.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "core/base/sha256.h"
#include "core/base/status.h"

namespace ccst::server {
namespace {

// Tells tokens of ours from others; it keeps nothing secret.
constexpr std::size_t kCheckSize = 8;

std::string Check(const std::string& list, const std::string& key) {
  return Sha256Of(absl::StrCat(list, ":", key)).substr(0, kCheckSize);
}

}  // namespace

std::string MakePageToken(const std::string& list, const PageKey& key) {
  const std::string text = absl::StrCat(absl::ToUnixMicros(key.create_time), ":", key.id);
  return absl::WebSafeBase64Escape(absl::StrCat(Check(list, text), text));
}

absl::StatusOr<PageKey> ParsePageToken(const std::string& list, const std::string& token) {
  if (token.empty()) return PageKey{};
  std::string decoded;
  if (absl::WebSafeBase64Unescape(token, &decoded) && decoded.size() > kCheckSize) {
    const std::string text = decoded.substr(kCheckSize);
    const std::size_t colon = text.find(':');
    std::int64_t micros = 0;
    if (decoded.substr(0, kCheckSize) == Check(list, text) && colon != std::string::npos &&
        absl::SimpleAtoi(text.substr(0, colon), &micros)) {
      return PageKey{absl::FromUnixMicros(micros), text.substr(colon + 1)};
    }
  }
  return MakeError(absl::StatusCode::kInvalidArgument, ErrorReason::kRequestInvalid,
                   "page_token is not one that a list of " + list +
                       " gave: take next_page_token of the page before");
}

}  // namespace ccst::server
