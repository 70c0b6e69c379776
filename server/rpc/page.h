#pragma once

#include <cstdint>
#include <string>
#include <utility>

#include <google/protobuf/repeated_ptr_field.h>

#include "absl/status/status.h"
#include "core/base/status.h"
#include "server/store/records.h"

namespace ccst::server {

/// Most bytes of the entries of one page, which is less than every client takes in a message. An
/// entry has far less, see FieldLimits().
inline constexpr std::int64_t kMaxPageBytes = std::int64_t{2} << 20;

/// Fills `entries` and `next_page_token` with one page of a list. It has at most `page_size`
/// entries and ends early where they would have more than kMaxPageBytes together.
/// @param list     the page of so many records, a StatusOr<Page<Record>>
/// @param convert  a record as an entry
template <typename Entry, typename List, typename Convert>
absl::Status FillPage(int page_size, const List& list, const Convert& convert,
                      google::protobuf::RepeatedPtrField<Entry>& entries,
                      std::string& next_page_token) {
  while (true) {
    auto page = list(page_size);
    if (!page.ok()) return page.status();
    entries.Clear();
    std::int64_t bytes = 0;
    int taken = 0;
    for (const auto& record : page->records) {
      Entry entry = convert(record);
      bytes += static_cast<std::int64_t>(entry.ByteSizeLong());
      if (bytes > kMaxPageBytes && taken > 0) break;
      entries.Add(std::move(entry));
      ++taken;
    }
    if (taken == static_cast<int>(page->records.size())) {
      next_page_token = std::move(page->next_token);
      return absl::OkStatus();
    }
    // Only the store makes tokens: asked for as many as fit it says where the next page starts.
    page_size = taken;
  }
}

}  // namespace ccst::server
