#pragma once

#include <string>

#include "absl/status/status.h"
#include "server/auth/tls_files.h"

namespace ccst::server {

/// Who may connect, and how.
struct SecurityOptions {
  TlsPaths tls;                   ///< Empty paths: no TLS.
  std::string health_cert;        ///< What --health shows where callers need a certificate; empty:
  std::string health_key;         ///< the server's own.
  std::string auth_token_file;    ///< Empty: calls need no token.
  bool insecure = false;          ///< Other machines may connect without encryption.
  bool without_proxy = false;     ///< Other machines may connect without a proxy in between.
  bool metrics_insecure = false;  ///< Other machines may read the metrics.
  bool reflection = false;        ///< Reflection also where other machines may connect.

  bool has_tls() const { return !tls.certificate.empty(); }

  /// INVALID_ARGUMENT OPTION_INVALID for files that do not go together, and for a `listen` or
  /// `metrics_listen` (HOST:PORT; the latter may be empty) that other machines reach unencrypted
  /// without `insecure`, the metrics also without `metrics_insecure`, or the former without a proxy
  /// in between and without `without_proxy`; says what to do.
  absl::Status Validate(const std::string& listen, const std::string& metrics_listen) const;

  /// INVALID_ARGUMENT | NOT_FOUND  a file is missing or broken; as the server would find it.
  absl::Status CheckFiles() const;
};

}  // namespace ccst::server
