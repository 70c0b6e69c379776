#include "server/auth/authenticator.h"

#include <utility>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "core/base/status.h"

namespace ccst::server {
namespace {

constexpr absl::string_view kScheme = "bearer ";

absl::Status Unauthenticated(std::string_view message) {
  return MakeError(absl::StatusCode::kUnauthenticated, ErrorReason::kUnauthenticated, message);
}

absl::StatusOr<Caller> CallerWithoutToken(const Peer& peer) {
  if (!peer.certificate.has_value()) {
    return Caller{.owner = Printable(peer.address), .scope = Scope::kFull};
  }
  CCST_RETURN_IF_ERROR(peer.certificate->status());
  const CertificateIdentity& identity = **peer.certificate;
  return Caller{
      .owner = identity.owner, .scope = Scope::kFull, .known = true, .label = identity.label};
}

}  // namespace

absl::Status Authenticator::UseTokens(const std::string& path,
                                      std::function<void(const std::string&)> report) {
  const std::lock_guard lock(mutex_);
  path_ = path;
  report_ = std::move(report);
  const absl::Status status = Load();
  if (status.ok()) return status;
  return MakeError(status.code(), ErrorReason::kOptionInvalid,
                   absl::StrCat("--auth-token-file: ", status.message()));
}

absl::StatusOr<Caller> Authenticator::Authenticate(std::string_view authorization,
                                                   const Peer& peer) {
  if (path_.empty()) return CallerWithoutToken(peer);
  if (authorization.empty()) {
    return Unauthenticated("this server needs a token: authorization: Bearer TOKEN");
  }
  if (!absl::StartsWithIgnoreCase(absl::string_view(authorization.data(), authorization.size()),
                                  kScheme)) {
    return Unauthenticated("the authorization is no bearer token");
  }
  const std::lock_guard lock(mutex_);
  ReloadIfChanged();
  const Caller* caller = FindCaller(tokens_, authorization.substr(kScheme.size()));
  if (caller == nullptr) return Unauthenticated("the token is not known");
  return *caller;
}

absl::Status Authenticator::Load() {
  // Before reading: a change in between is seen at the next look.
  stamp_ = StampOf(path_);
  CCST_ASSIGN_OR_RETURN(const std::string text, ReadSmallFile(path_));
  CCST_ASSIGN_OR_RETURN(tokens_, ParseTokens(text));
  return absl::OkStatus();
}

void Authenticator::ReloadIfChanged() {
  if (StampOf(path_) == stamp_) return;
  if (const absl::Status status = Load(); status.ok()) {
    report_(absl::StrCat("tokens reloaded: ", tokens_.size()));
  } else {
    report_(absl::StrCat("tokens not reloaded, the old ones stay: ", status.message()));
  }
}

absl::Status CheckScope(const Caller& caller, Scope needed) {
  if (caller.scope >= needed) return absl::OkStatus();
  return MakeError(absl::StatusCode::kPermissionDenied, ErrorReason::kPermissionDenied,
                   "the token is read-only; this call needs one of scope full");
}

}  // namespace ccst::server
