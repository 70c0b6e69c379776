#pragma once

#include <memory>
#include <string>
#include <string_view>

#include <grpcpp/channel.h>

#include "absl/status/statusor.h"

namespace ccst {

/// How to reach a server. PEM fields hold text, not paths.
struct Connection {
  std::string address = {};      ///< HOST:PORT
  std::string ca = {};           ///< PEM of who vouches for the server; empty: no TLS.
  std::string certificate = {};  ///< PEM of this client's chain, where the server wants one.
  std::string key = {};          ///< PEM of its private key.
  std::string token = {};        ///< Sent with every call; empty: none.
  bool insecure = false;         ///< Send the token to other machines without TLS.
};

/// Whether a token can be sent: empty, or at most 4096 characters of printable ASCII without
/// spaces.
bool IsToken(std::string_view text);
/// Says so.
inline constexpr std::string_view kTokenForm =
    "holds no token: that is at most 4096 letters, digits and signs of ASCII, without spaces";

/// A channel that connects at first use and brings the token with every call.
/// @errors INVALID_ARGUMENT OPTION_INVALID  a token for another machine without TLS or `insecure`;
///         a token that is none, see IsToken(); a certificate without key or CA
absl::StatusOr<std::shared_ptr<grpc::Channel>> OpenChannel(const Connection& connection);

}  // namespace ccst
