#include "client/cli/server_flags.h"

#include <cstdint>
#include <cstdlib>
#include <utility>

#include <CLI/CLI.hpp>

#include "absl/strings/ascii.h"
#include "client/lib/connection.h"
#include "core/base/status.h"
#include "core/io/whole_file.h"

namespace ccst::cli {
namespace {

constexpr std::int64_t kMaxFileBytes = std::int64_t{1} << 20;
constexpr char kTokenVariable[] = "CCST_TOKEN";

// Empty for an empty path.
absl::StatusOr<std::string> Read(const std::string& path) {
  if (path.empty()) return std::string();
  return io::ReadWholeFile(path, kMaxFileBytes);
}

absl::StatusOr<std::string> ReadToken(const std::string& path) {
  const char* variable = std::getenv(kTokenVariable);
  std::string token = variable == nullptr ? "" : variable;
  if (!path.empty()) {
    CCST_ASSIGN_OR_RETURN(token, Read(path));
  }
  absl::StripAsciiWhitespace(&token);
  return token;
}

}  // namespace

void AddServerFlags(CLI::App& app, ServerFlags& flags) {
  app.add_option("--tls-ca", flags.tls_ca, "Reach the server with TLS: who vouches for it (PEM)")
      ->type_name("FILE");
  app.add_option("--tls-cert", flags.tls_cert, "Certificate to show to the server (PEM)")
      ->type_name("FILE");
  app.add_option("--tls-key", flags.tls_key, "Private key of --tls-cert (PEM)")->type_name("FILE");
  app.add_option("--token-file", flags.token_file, "Token for the server; else $CCST_TOKEN")
      ->type_name("FILE");
  app.add_flag("--insecure", flags.insecure, "Send the token to other machines without TLS");
}

absl::StatusOr<Client> ConnectTo(const std::string& address, const ServerFlags& flags) {
  Connection connection;
  connection.address = address;
  connection.insecure = flags.insecure;
  CCST_ASSIGN_OR_RETURN(connection.ca, Read(flags.tls_ca));
  CCST_ASSIGN_OR_RETURN(connection.certificate, Read(flags.tls_cert));
  CCST_ASSIGN_OR_RETURN(connection.key, Read(flags.tls_key));
  CCST_ASSIGN_OR_RETURN(connection.token, ReadToken(flags.token_file));
  return Client::Connect(connection);
}

}  // namespace ccst::cli
