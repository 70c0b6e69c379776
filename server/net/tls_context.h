#pragma once

#include <functional>
#include <memory>
#include <string>

#include <openssl/ssl.h>

#include "absl/status/statusor.h"
#include "server/auth/tls_files.h"

namespace ccst::server {

using TlsSession = std::unique_ptr<SSL, decltype(&SSL_free)>;

/// What HTTP/2 is called in the handshake, with its length (RFC 7301, 3.1).
inline constexpr unsigned char kAlpnHttp2[] = {2, 'h', '2'};

/// TLS 1.2 and later for HTTP/2, from files that are looked at with every new connection: changed
/// ones count at once, broken ones not, the certificate before stays. Clients need a certificate
/// when the paths name who vouches for them. Sessions are not resumed, so that a certificate that
/// is not vouched for any more opens no new connection. Not thread-safe.
class TlsContext {
 public:
  /// @param report  is told of changes, in words without paths.
  /// @errors those of LoadTls()
  static absl::StatusOr<std::unique_ptr<TlsContext>> Load(
      const TlsPaths& paths, std::function<void(const std::string&)> report);

  /// A server's end of a new connection. Null when memory is short.
  /// @param from_here  it is the server's own, which needs no certificate.
  TlsSession NewSession(bool from_here);

 private:
  using Context = std::unique_ptr<SSL_CTX, decltype(&SSL_CTX_free)>;

  TlsContext(TlsPaths paths, TlsStamps stamps, Context context,
             std::function<void(const std::string&)> report);
  static absl::StatusOr<Context> Make(const TlsMaterial& material);
  void ReloadIfChanged();

  const TlsPaths paths_;
  const std::function<void(const std::string&)> report_;
  TlsStamps stamps_;
  Context context_;
};

}  // namespace ccst::server
