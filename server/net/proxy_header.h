#pragma once

#include <cstddef>
#include <span>

#include "absl/status/statusor.h"
#include "server/net/machine_address.h"

namespace ccst::server {

/// Bytes of the fixed part of a header of the PROXY protocol, version 2, and the first of them.
inline constexpr std::size_t kProxyHeaderStart = 16;
inline constexpr char kProxyHeaderFirstByte = '\r';

/// How many bytes follow the fixed part.
/// @errors INVALID_ARGUMENT  `start`, of kProxyHeaderStart bytes, begins no such header, or one
///         longer than any proxy needs
absl::StatusOr<std::size_t> ProxyHeaderRest(std::span<const char> start);

/// For whom a proxy forwards, from a whole header. What the proxy asks for itself, as when it looks
/// whether the server is there, comes from `unix`.
/// @errors INVALID_ARGUMENT  the header is broken or names no IP address
absl::StatusOr<MachineAddress> ParseProxyHeader(std::span<const char> header);

}  // namespace ccst::server
