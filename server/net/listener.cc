#include "server/net/listener.h"

#include <cerrno>
#include <cstring>
#include <memory>
#include <optional>

#include <netdb.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include "absl/strings/str_cat.h"
#include "absl/strings/string_view.h"
#include "absl/strings/strip.h"
#include "server/net/machine_address.h"

namespace ccst::server {
namespace {

using Addresses = std::unique_ptr<addrinfo, decltype(&freeaddrinfo)>;

// The kernel cuts it to what net.core.somaxconn allows.
constexpr int kWaitingConnections = 4096;
constexpr mode_t kSocketMode = 0660;

absl::Status CannotListen(const std::string& address) {
  return absl::UnavailableError(absl::StrCat("cannot listen on ", address,
                                             "; the address may be in use or not of this machine"));
}

FileDescriptor NewSocket(int family) {
  return FileDescriptor(socket(family, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
}

Addresses Resolve(std::string host, const std::string& port) {
  if (absl::StartsWith(host, "[") && absl::EndsWith(host, "]")) {
    host = host.substr(1, host.size() - 2);
  }
  addrinfo hints = {};
  hints.ai_socktype = SOCK_STREAM;
  hints.ai_flags = AI_PASSIVE | AI_NUMERICSERV;
  addrinfo* found = nullptr;
  if (getaddrinfo(host.c_str(), port.c_str(), &hints, &found) != 0) found = nullptr;
  return Addresses(found, freeaddrinfo);
}

bool IsAnyIpv6(const addrinfo& address) {
  return address.ai_family == AF_INET6 &&
         IN6_IS_ADDR_UNSPECIFIED(
             &reinterpret_cast<const sockaddr_in6*>(address.ai_addr)->sin6_addr);
}

// Not open when the address is not to be had. Without SO_REUSEPORT: two servers on one port would
// share its callers by chance.
FileDescriptor ListenAtOne(const addrinfo& address, int port) {
  FileDescriptor socket = NewSocket(address.ai_family);
  if (!socket.is_open()) return socket;
  const int on = 1;
  const int only_ipv6 = IsAnyIpv6(address) ? 0 : 1;
  setsockopt(socket.get(), SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
  if (address.ai_family == AF_INET6) {
    setsockopt(socket.get(), IPPROTO_IPV6, IPV6_V6ONLY, &only_ipv6, sizeof only_ipv6);
  }
  sockaddr_storage place = {};
  std::memcpy(&place, address.ai_addr, address.ai_addrlen);
  const auto wire_port = htons(static_cast<std::uint16_t>(port));
  if (address.ai_family == AF_INET6) {
    reinterpret_cast<sockaddr_in6*>(&place)->sin6_port = wire_port;
  } else {
    reinterpret_cast<sockaddr_in*>(&place)->sin_port = wire_port;
  }
  if (bind(socket.get(), reinterpret_cast<const sockaddr*>(&place), address.ai_addrlen) != 0 ||
      listen(socket.get(), kWaitingConnections) != 0) {
    socket.Close();
  }
  return socket;
}

int PortOf(const FileDescriptor& socket) {
  sockaddr_storage place = {};
  socklen_t size = sizeof place;
  getsockname(socket.get(), reinterpret_cast<sockaddr*>(&place), &size);
  return MachineAddressOf(place).port;
}

// True when somebody accepts connections there.
bool IsAlive(const sockaddr_un& place) {
  const FileDescriptor probe = NewSocket(AF_UNIX);
  return connect(probe.get(), reinterpret_cast<const sockaddr*>(&place), sizeof place) == 0 ||
         errno != ECONNREFUSED;
}

bool IsSocket(const std::string& path) {
  struct stat info = {};
  return lstat(path.c_str(), &info) == 0 && S_ISSOCK(info.st_mode);
}

}  // namespace

absl::StatusOr<Listener> ListenAt(const std::string& host_port) {
  const std::size_t colon = host_port.rfind(':');
  if (colon == std::string::npos) return CannotListen(host_port);
  const std::string host = host_port.substr(0, colon);
  const Addresses addresses = Resolve(host, host_port.substr(colon + 1));
  Listener listener;
  int port = 0;
  for (const addrinfo* one = addresses.get(); one != nullptr; one = one->ai_next) {
    if (one->ai_family != AF_INET && one->ai_family != AF_INET6) continue;
    if (port == 0) port = ntohs(reinterpret_cast<const sockaddr_in*>(one->ai_addr)->sin_port);
    FileDescriptor socket = ListenAtOne(*one, port);
    if (!socket.is_open()) continue;
    port = PortOf(socket);
    listener.sockets.push_back(std::move(socket));
  }
  if (listener.sockets.empty()) return CannotListen(host_port);
  listener.address = absl::StrCat(host, ":", port);
  return listener;
}

absl::StatusOr<Listener> ListenAtPath(const std::string& path) {
  sockaddr_un place = {};
  place.sun_family = AF_UNIX;
  if (path.empty() || path.size() >= sizeof place.sun_path) return CannotListen(path);
  std::memcpy(place.sun_path, path.data(), path.size());
  if (IsSocket(path)) {
    if (IsAlive(place)) return CannotListen(path);
    unlink(path.c_str());
  }
  FileDescriptor socket = NewSocket(AF_UNIX);
  if (!socket.is_open() ||
      bind(socket.get(), reinterpret_cast<const sockaddr*>(&place), sizeof place) != 0 ||
      chmod(path.c_str(), kSocketMode) != 0 || listen(socket.get(), kWaitingConnections) != 0) {
    return CannotListen(path);
  }
  Listener listener;
  listener.address = path;
  listener.sockets.push_back(std::move(socket));
  return listener;
}

}  // namespace ccst::server
