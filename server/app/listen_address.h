#pragma once

#include <string>

#include "absl/status/statusor.h"

namespace ccst::server {

/// Where to listen.
struct ListenAddress {
  std::string host;  ///< An IPv4 address, an IPv6 address without brackets, or a name.
  int port = 0;      ///< [0, 65535]; 0 picks a free one.
  bool is_ipv6 = false;

  /// All addresses of the machine.
  bool is_any() const;
  /// HOST:PORT, with brackets around an IPv6 address.
  std::string ToText() const;
};

/// Parses HOST:PORT strictly: libraries take lists, ports beyond the last one and names that are
/// numbers for something, which is not what the one who wrote them meant.
/// @errors INVALID_ARGUMENT OPTION_INVALID  says what `text` should be
absl::StatusOr<ListenAddress> ParseListenAddress(const std::string& text);

}  // namespace ccst::server
