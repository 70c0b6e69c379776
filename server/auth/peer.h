#pragma once

#include <optional>
#include <string>

#include "absl/status/statusor.h"
#include "server/auth/certificate_identity.h"

namespace ccst::server {

/// The other end of a connection: what is known of a caller without a token.
struct Peer {
  std::string address = {};  ///< Of its machine, without the port, which is another one each time.
  /// Whom its certificate names, or why that cannot be said; absent where it showed none.
  std::optional<absl::StatusOr<CertificateIdentity>> certificate = std::nullopt;
  /// A proxy that is trusted speaks for it, and may say with each call whose certificate it saw.
  bool vouched_by_proxy = false;
};

}  // namespace ccst::server
