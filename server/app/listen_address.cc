#include "server/app/listen_address.h"

#include <algorithm>
#include <optional>
#include <string_view>

#include <arpa/inet.h>

#include "absl/strings/ascii.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "core/base/printable_text.h"
#include "core/base/status.h"

namespace ccst::server {
namespace {

constexpr int kMaxPort = 65535;
constexpr std::size_t kMaxPortDigits = 5;
constexpr std::size_t kMaxName = 253;
constexpr std::size_t kMaxLabel = 63;
constexpr std::size_t kMaxShown = 100;

bool AreDigits(std::string_view text) {
  return !text.empty() && std::all_of(text.begin(), text.end(), [](char c) {
    return absl::ascii_isdigit(static_cast<unsigned char>(c));
  });
}

bool IsIpv4(const std::string& text) {
  in_addr ip = {};
  return inet_pton(AF_INET, text.c_str(), &ip) == 1;
}

// Perhaps with %ZONE behind, which link-local addresses need.
bool IsIpv6(const std::string& text) {
  const std::size_t zone = text.find('%');
  const bool zone_is_right =
      zone == std::string::npos ||
      (zone + 1 < text.size() &&
       std::all_of(text.begin() + static_cast<std::ptrdiff_t>(zone) + 1, text.end(), [](char c) {
         return absl::ascii_isalnum(static_cast<unsigned char>(c)) || c == '-' || c == '_' ||
                c == '.';
       }));
  in6_addr ip = {};
  return zone_is_right && inet_pton(AF_INET6, text.substr(0, zone).c_str(), &ip) == 1;
}

bool IsLabel(std::string_view label) {
  return !label.empty() && label.size() <= kMaxLabel && label.front() != '-' &&
         label.back() != '-' && std::all_of(label.begin(), label.end(), [](char c) {
           return absl::ascii_isalnum(static_cast<unsigned char>(c)) || c == '-';
         });
}

// A name for the resolver; numbers alone are addresses in odd forms to it.
bool IsHostName(const std::string& text) {
  const std::vector<std::string> labels = absl::StrSplit(text, '.');
  return text.size() <= kMaxName && !AreDigits(labels.back()) &&
         std::all_of(labels.begin(), labels.end(),
                     [](const std::string& label) { return IsLabel(label); });
}

std::optional<int> PortOf(const std::string& text) {
  int port = 0;
  if (!AreDigits(text) || text.size() > kMaxPortDigits || !absl::SimpleAtoi(text, &port) ||
      port > kMaxPort) {
    return std::nullopt;
  }
  return port;
}

absl::Status WrongAddress(const std::string& text) {
  return MakeError(absl::StatusCode::kInvalidArgument, ErrorReason::kOptionInvalid,
                   absl::StrCat("must be one HOST:PORT, an address or a name and a port in [0, ",
                                kMaxPort, "], as 127.0.0.1:50051 or [::1]:50051; is \"",
                                PrintableExcerpt(text, kMaxShown), "\""));
}

}  // namespace

bool ListenAddress::is_any() const {
  in6_addr ip = {};
  if (is_ipv6) return inet_pton(AF_INET6, host.c_str(), &ip) == 1 && IN6_IS_ADDR_UNSPECIFIED(&ip);
  return host == "0.0.0.0";
}

std::string ListenAddress::ToText() const {
  return is_ipv6 ? absl::StrCat("[", host, "]:", port) : absl::StrCat(host, ":", port);
}

absl::StatusOr<ListenAddress> ParseListenAddress(const std::string& text) {
  const std::size_t colon = text.rfind(':');
  // The system's functions would take what is in front of it.
  const bool has_end = text.find('\0') != std::string::npos;
  if (colon == std::string::npos || has_end) return WrongAddress(text);
  const auto port = PortOf(text.substr(colon + 1));
  if (!port.has_value()) return WrongAddress(text);
  const std::string host = text.substr(0, colon);
  if (host.size() > 2 && host.front() == '[' && host.back() == ']') {
    const std::string inner = host.substr(1, host.size() - 2);
    if (!IsIpv6(inner)) return WrongAddress(text);
    return ListenAddress{.host = inner, .port = *port, .is_ipv6 = true};
  }
  if (!IsIpv4(host) && !IsHostName(host)) return WrongAddress(text);
  return ListenAddress{.host = host, .port = *port};
}

}  // namespace ccst::server
