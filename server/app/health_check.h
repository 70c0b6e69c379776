#pragma once

#include "absl/status/status.h"
#include "server/app/server_options.h"

namespace ccst::server {

/// Asks the server that runs on this machine with `options` whether it serves, as a container's
/// health check does. With TLS any certificate will do, as who asks is on the same machine; where
/// callers need a certificate, `health_cert` or else the server's own is shown: `client_ca` must
/// vouch for it, and it must be good for clients. The environment's proxies are not used. Blocks
/// for at most 4 s.
/// @errors UNAVAILABLE          nobody answers there, or not in time
///         FAILED_PRECONDITION  it answers that it does not serve: it drains
///         those of LoadTls()
absl::Status CheckHealth(const ServerOptions& options);

}  // namespace ccst::server
