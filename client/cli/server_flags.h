#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "client/cli/distinct_files.h"
#include "client/lib/client.h"

namespace CLI {  // NOLINT(readability-identifier-naming): the library's.
class App;
}

namespace ccst::cli {

/// How a server is reached, as flags say it: paths of files, empty where none was given.
struct ServerFlags {
  std::string tls_ca;
  std::string tls_cert;
  std::string tls_key;
  std::string token_file;
  bool insecure = false;
};

/// Adds --tls-ca, --tls-cert, --tls-key, --token-file and --insecure.
void AddServerFlags(CLI::App& app, ServerFlags& flags);

/// The files among them, which no output may overwrite.
std::vector<NamedFile> FilesOf(const ServerFlags& flags);

/// A client of the server at `address`, with the contents of the files and the token: that of
/// --token-file, else CCST_TOKEN, else none.
/// @errors those of reading the files and of Client::Connect() | INVALID_ARGUMENT OPTION_INVALID a
///         token that is none: several lines, a character that is not printable ASCII
absl::StatusOr<Client> ConnectTo(const std::string& address, const ServerFlags& flags);

}  // namespace ccst::cli
