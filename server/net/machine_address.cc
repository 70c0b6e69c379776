#include "server/net/machine_address.h"

#include <algorithm>
#include <array>
#include <cstring>

#include <arpa/inet.h>
#include <netinet/in.h>

#include "absl/strings/str_cat.h"

namespace ccst::server {
namespace {

constexpr std::size_t kMappedPrefix = 12;
constexpr std::size_t kNetworkBytes = 8;

}  // namespace

MachineAddress MachineAddressOfIpv4(const void* four_bytes, int port) {
  std::array<char, INET_ADDRSTRLEN> text = {};
  inet_ntop(AF_INET, four_bytes, text.data(), text.size());
  return {.text = text.data(), .network = text.data(), .port = port};
}

MachineAddress MachineAddressOfIpv6(const void* sixteen_bytes, int port) {
  in6_addr address = {};
  std::memcpy(&address, sixteen_bytes, sizeof address);
  if (IN6_IS_ADDR_V4MAPPED(&address)) {
    return MachineAddressOfIpv4(&address.s6_addr[kMappedPrefix], port);
  }
  in6_addr network = address;
  std::fill(std::begin(network.s6_addr) + kNetworkBytes, std::end(network.s6_addr), 0);
  std::array<char, INET6_ADDRSTRLEN> text = {};
  std::array<char, INET6_ADDRSTRLEN> network_text = {};
  inet_ntop(AF_INET6, &address, text.data(), text.size());
  inet_ntop(AF_INET6, &network, network_text.data(), network_text.size());
  return {.text = absl::StrCat("[", text.data(), "]"),
          .network = absl::StrCat(network_text.data(), "/64"),
          .port = port};
}

MachineAddress MachineAddressOf(const sockaddr_storage& address) {
  if (address.ss_family == AF_INET) {
    sockaddr_in ipv4 = {};
    std::memcpy(&ipv4, &address, sizeof ipv4);
    return MachineAddressOfIpv4(&ipv4.sin_addr, ntohs(ipv4.sin_port));
  }
  if (address.ss_family == AF_INET6) {
    sockaddr_in6 ipv6 = {};
    std::memcpy(&ipv6, &address, sizeof ipv6);
    return MachineAddressOfIpv6(&ipv6.sin6_addr, ntohs(ipv6.sin6_port));
  }
  return {.text = "unix", .network = "unix"};
}

}  // namespace ccst::server
