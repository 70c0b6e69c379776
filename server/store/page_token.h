#pragma once

#include <string>

#include "absl/status/statusor.h"
#include "absl/time/time.h"

namespace ccst::server {

/// Where a page of a list, newest first, starts: behind the record of this time and id. So pages
/// stay as they are while records are added.
struct PageKey {
  absl::Time create_time = absl::InfiniteFuture();
  std::string id;
};

/// The key as an opaque token for the list called `list`; printable.
std::string MakePageToken(const std::string& list, const PageKey& key);

/// The key of a token; the very first place for an empty one.
/// @errors INVALID_ARGUMENT REQUEST_INVALID when MakePageToken() did not make it for this list
absl::StatusOr<PageKey> ParsePageToken(const std::string& list, const std::string& token);

}  // namespace ccst::server
