#pragma once

#include <array>
#include <string>

#include "absl/status/statusor.h"
#include "server/auth/watched_file.h"

namespace ccst::server {

/// Where the files of a TLS server lie.
struct TlsPaths {
  std::string certificate;  ///< PEM: the server's certificate, then those that vouch for it.
  std::string key;          ///< PEM: its private key, without a passphrase.
  std::string client_ca =
      {};  ///< PEM: who vouches for clients; empty: clients need no certificate.
};

/// What is in them.
struct TlsMaterial {
  std::string certificate;
  std::string key;
  std::string client_ca;
};

/// Stamps of all three files.
using TlsStamps = std::array<FileStamp, 3>;
TlsStamps StampsOf(const TlsPaths& paths);

/// Reads and checks the files, so that a broken one is never put to use.
/// @errors INVALID_ARGUMENT, NOT_FOUND OPTION_INVALID  a file is not there, holds no PEM of its
///         kind, or the key is not the certificate's; names the flag, not the path
absl::StatusOr<TlsMaterial> LoadTls(const TlsPaths& paths);

}  // namespace ccst::server
