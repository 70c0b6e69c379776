#include "core/base/loopback.h"

#include <string>

#include <arpa/inet.h>

namespace ccst {

bool IsLoopback(std::string_view address) {
  if (address.substr(0, 1) == "[") {
    in6_addr ip = {};
    const std::size_t end = address.find(']');
    if (end == std::string_view::npos) return false;
    const std::string host(address.substr(1, end - 1));
    return inet_pton(AF_INET6, host.c_str(), &ip) == 1 && IN6_IS_ADDR_LOOPBACK(&ip);
  }
  const std::string host(address.substr(0, address.find(':')));
  in_addr ip = {};
  return host == "localhost" ||
         (inet_pton(AF_INET, host.c_str(), &ip) == 1 && ntohl(ip.s_addr) >> 24 == 127);
}

}  // namespace ccst
