#include "client/cli/server_flags.h"

#include <cstdint>
#include <cstdlib>
#include <utility>

#include <CLI/CLI.hpp>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/strip.h"
#include "client/lib/connection.h"
#include "core/base/status.h"
#include "core/io/whole_file.h"

namespace ccst::cli {
namespace {

constexpr std::int64_t kMaxFileBytes = std::int64_t{1} << 20;
constexpr char kTokenVariable[] = "CCST_TOKEN";
// What editors put in front of a text.
constexpr char kUtf8Mark[] = "\xef\xbb\xbf";
constexpr char kUtf16Little[] = "\xff\xfe";
constexpr char kUtf16Big[] = "\xfe\xff";

// Empty for an empty path.
absl::StatusOr<std::string> Read(const std::string& path) {
  if (path.empty()) return std::string();
  return io::ReadWholeFile(path, kMaxFileBytes);
}

absl::Status Wrong(const std::string& source, std::string_view message) {
  return MakeError(absl::StatusCode::kInvalidArgument, ErrorReason::kOptionInvalid,
                   absl::StrCat(source, ": ", std::string(message)));
}

// The token in `text`, which `source` held. Says nothing of the text, which is a secret.
absl::StatusOr<std::string> TokenIn(const std::string& text, const std::string& source) {
  if (absl::StartsWith(text, kUtf16Little) || absl::StartsWith(text, kUtf16Big)) {
    return Wrong(source, "is UTF-16; save it as UTF-8 or ASCII");
  }
  const absl::string_view token = absl::StripAsciiWhitespace(absl::StripPrefix(text, kUtf8Mark));
  if (token.find_first_of("\r\n") != absl::string_view::npos) {
    return Wrong(source, "has several lines; a token is one line");
  }
  if (!IsToken({token.data(), token.size()})) {
    return Wrong(source, kTokenForm);
  }
  return std::string(token);
}

// Empty where there is none.
absl::StatusOr<std::string> ReadToken(const std::string& path) {
  if (path.empty()) {
    const char* variable = std::getenv(kTokenVariable);
    return TokenIn(variable == nullptr ? "" : variable, kTokenVariable);
  }
  CCST_ASSIGN_OR_RETURN(const std::string text, Read(path));
  CCST_ASSIGN_OR_RETURN(std::string token, TokenIn(text, path));
  if (token.empty()) return Wrong(path, "is empty; it must hold a token");
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

std::vector<NamedFile> FilesOf(const ServerFlags& flags) {
  return {{"--tls-ca", flags.tls_ca},
          {"--tls-cert", flags.tls_cert},
          {"--tls-key", flags.tls_key},
          {"--token-file", flags.token_file}};
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
