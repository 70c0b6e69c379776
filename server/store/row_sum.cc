#include "server/store/row_sum.h"

#include "absl/strings/str_cat.h"

namespace ccst::server {
namespace {

// Against damage, which nobody chooses, 64 bits are more than enough.
constexpr std::size_t kDigits = 16;

}  // namespace

RowSum& RowSum::Add(std::string_view text) {
  // With its length, so that no text can be taken for the next one's begin.
  hash_.Add(absl::StrCat(text.size(), ":"));
  hash_.Add(text);
  return *this;
}

RowSum& RowSum::Add(std::int64_t number) { return Add(std::string_view(absl::StrCat(number))); }

RowSum& RowSum::Add(const std::optional<absl::Time>& time) {
  return time.has_value() ? Add(*time) : Add(std::string_view("none"));
}

std::string RowSum::Finish() { return hash_.Finish().substr(0, kDigits); }

}  // namespace ccst::server
