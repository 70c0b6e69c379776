#pragma once

#include <string>

#include <sys/socket.h>

namespace ccst::server {

/// The machine at the other end of a socket.
struct MachineAddress {
  std::string text;  ///< `10.0.0.1`, `[2001:db8::1]`, or `unix` for this machine's own sockets.
  /// What limits by address count as one: an IPv4 address, or the 64-bit network of an IPv6
  /// address, all of which usually belongs to one customer.
  std::string network;
  int port = 0;  ///< 0 for a Unix socket.
};

/// Of an address from accept() or getpeername(). IPv4 within IPv6 counts as IPv4.
MachineAddress MachineAddressOf(const sockaddr_storage& address);

/// Of the bytes of an address in network order, with the port.
MachineAddress MachineAddressOfIpv4(const void* four_bytes, int port);
MachineAddress MachineAddressOfIpv6(const void* sixteen_bytes, int port);

}  // namespace ccst::server
