#pragma once

#include <functional>
#include <memory>
#include <string>

#include <grpcpp/security/server_credentials.h>

#include "absl/status/statusor.h"
#include "server/auth/tls_files.h"

namespace ccst::server {

/// TLS from files that are looked at with every new connection: changed ones count at once, broken
/// ones not, the certificate before stays. `report` is told either, in words without paths.
/// Clients need a certificate when `paths` names who vouches for them. The credentials must outlive
/// the server that listens with them.
/// @errors those of LoadTls()
absl::StatusOr<std::shared_ptr<grpc::ServerCredentials>> WatchedTlsCredentials(
    const TlsPaths& paths, std::function<void(const std::string&)> report);

}  // namespace ccst::server
