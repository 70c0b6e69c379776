#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "server/net/file_descriptor.h"

namespace ccst::server {

/// Sockets that listen at one address.
struct Listener {
  std::vector<FileDescriptor> sockets;
  std::string address;  ///< HOST:PORT with the port really listened on, or the path.
};

/// Listens at HOST:PORT: at all addresses of a name, on one port; port 0 picks a free one. `[::]`
/// is every address of the machine, IPv4 too, `0.0.0.0` every one of IPv4. No other program can
/// listen at the same place.
/// @errors UNAVAILABLE  the address is in use, not of this machine, or unknown
absl::StatusOr<Listener> ListenAt(const std::string& host_port);

/// Listens at a Unix socket, to which its group may connect. A socket that a program left there is
/// replaced; one on which somebody listens, and a file of another kind, are not.
/// @errors UNAVAILABLE  there is no such folder, it may not be written, or the path is taken
absl::StatusOr<Listener> ListenAtPath(const std::string& path);

}  // namespace ccst::server
