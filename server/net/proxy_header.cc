#include "server/net/proxy_header.h"

#include <algorithm>
#include <array>

#include "core/base/status.h"

namespace ccst::server {
namespace {

// https://www.haproxy.org/download/2.6/doc/proxy-protocol.txt, section 2.2.
constexpr std::array<char, 12> kSignature = {'\r', '\n', '\r', '\n', '\0', '\r',
                                             '\n', 'Q',  'U',  'I',  'T',  '\n'};
constexpr std::size_t kCommandAt = 12;
constexpr std::size_t kFamilyAt = 13;
constexpr std::size_t kLengthAt = 14;
constexpr int kLocal = 0x20;
constexpr int kProxied = 0x21;
constexpr int kTcpOverIpv4 = 0x11;
constexpr int kTcpOverIpv6 = 0x21;
constexpr std::size_t kIpv4Bytes = 12;
constexpr std::size_t kIpv6Bytes = 36;
// Addresses, and room for what a proxy adds to them.
constexpr std::size_t kMaxRest = 2048;

int ByteAt(std::span<const char> bytes, std::size_t at) {
  return static_cast<unsigned char>(bytes[at]);
}

int NumberAt(std::span<const char> bytes, std::size_t at) {
  return ByteAt(bytes, at) << 8 | ByteAt(bytes, at + 1);
}

absl::Status Broken(absl::string_view message) { return absl::InvalidArgumentError(message); }

}  // namespace

absl::StatusOr<std::size_t> ProxyHeaderRest(std::span<const char> start) {
  if (start.size() < kProxyHeaderStart ||
      !std::equal(kSignature.begin(), kSignature.end(), start.begin())) {
    return Broken("no header of the PROXY protocol, version 2");
  }
  const auto rest = static_cast<std::size_t>(NumberAt(start, kLengthAt));
  if (rest > kMaxRest) return Broken("a header of the PROXY protocol that is too long");
  return rest;
}

absl::StatusOr<MachineAddress> ParseProxyHeader(std::span<const char> header) {
  CCST_ASSIGN_OR_RETURN(const std::size_t rest, ProxyHeaderRest(header));
  if (header.size() != kProxyHeaderStart + rest)
    return Broken("a cut header of the PROXY protocol");
  const int command = ByteAt(header, kCommandAt);
  if (command == kLocal) return MachineAddress{.text = "unix", .network = "unix"};
  if (command != kProxied) return Broken("an unknown command of the PROXY protocol");
  const int family = ByteAt(header, kFamilyAt);
  const std::span<const char> addresses = header.subspan(kProxyHeaderStart);
  // Source and destination, then their ports.
  if (family == kTcpOverIpv4 && rest >= kIpv4Bytes) {
    return MachineAddressOfIpv4(addresses.data(), NumberAt(addresses, 8));
  }
  if (family == kTcpOverIpv6 && rest >= kIpv6Bytes) {
    return MachineAddressOfIpv6(addresses.data(), NumberAt(addresses, 32));
  }
  return Broken("the PROXY protocol without an IP address");
}

}  // namespace ccst::server
