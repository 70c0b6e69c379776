#pragma once

#include <functional>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "server/auth/caller.h"
#include "server/auth/peer.h"
#include "server/auth/token.h"
#include "server/auth/watched_file.h"

namespace ccst::server {

/// Says who calls. Thread-safe.
class Authenticator {
 public:
  /// Without tokens: everybody may do everything, and is who its certificate says, else its
  /// address.
  Authenticator() = default;
  Authenticator(const Authenticator&) = delete;
  Authenticator& operator=(const Authenticator&) = delete;

  /// From now on only with the tokens of the file at `path`; call before the first call comes. The
  /// file is looked at with every call; a changed one counts at once, a broken or missing one not:
  /// the tokens before stay. `report` is told either, in words without the path or anything of the
  /// file's.
  /// @errors INVALID_ARGUMENT OPTION_INVALID naming the line | NOT_FOUND OPTION_INVALID it cannot
  ///         be read; names the flag, not the path
  absl::Status UseTokens(const std::string& path, std::function<void(const std::string&)> report);

  /// @param authorization  the call's `authorization` metadata; empty without one.
  /// @param peer           who calls where there are no tokens.
  /// @errors UNAUTHENTICATED no token or not a known one; without tokens, a certificate that names
  ///         nobody
  absl::StatusOr<Caller> Authenticate(std::string_view authorization, const Peer& peer);

 private:
  // Reads the file; the tokens stay as they are when it is broken.
  absl::Status Load();
  void ReloadIfChanged();

  std::string path_;  // Empty: no tokens.
  std::function<void(const std::string&)> report_;
  std::mutex mutex_;  // Of what follows.
  FileStamp stamp_;
  std::vector<TokenEntry> tokens_;
};

/// PERMISSION_DENIED when `caller` may not do what takes `needed`.
absl::Status CheckScope(const Caller& caller, Scope needed);

}  // namespace ccst::server
