#include "server/app/security_options.h"

#include "core/base/loopback.h"
#include "core/base/status.h"
#include "server/auth/authenticator.h"

namespace ccst::server {
namespace {

absl::Status Wrong(const std::string& message) {
  return MakeError(absl::StatusCode::kInvalidArgument, ErrorReason::kOptionInvalid, message);
}

}  // namespace

absl::Status SecurityOptions::Validate(const std::string& listen,
                                       const std::string& metrics_listen) const {
  if (tls.certificate.empty() != tls.key.empty()) {
    return Wrong("--tls-cert and --tls-key go together; one of them is missing");
  }
  if (!tls.client_ca.empty() && !has_tls()) {
    return Wrong("--tls-client-ca needs --tls-cert and --tls-key");
  }
  if (!IsLoopback(listen) && !has_tls() && !insecure) {
    return Wrong("--listen " + listen +
                 " is open to other machines, and meshes and tokens would travel unencrypted; give "
                 "--tls-cert and --tls-key, listen on 127.0.0.1, or accept it with --insecure");
  }
  if (!IsLoopback(listen) && !without_proxy) {
    return Wrong("--listen " + listen +
                 " is open to other machines without a proxy in between: nothing would limit how "
                 "often one of them connects and calls, and what they send would reach Debian's "
                 "gRPC, which has had no security fixes since 2023, with the worst of it filtered "
                 "alone; put the proxy of deploy/haproxy in front and give it --proxy-socket, or "
                 "accept it with --without-proxy");
  }
  if (!metrics_listen.empty() && !IsLoopback(metrics_listen) && !insecure && !metrics_insecure) {
    return Wrong("--metrics-listen " + metrics_listen +
                 " is open to other machines and never encrypted; listen on 127.0.0.1, or accept "
                 "it with --metrics-insecure");
  }
  if (health_cert.empty() != health_key.empty()) {
    return Wrong("--health-cert and --health-key go together; one of them is missing");
  }
  return absl::OkStatus();
}

absl::Status SecurityOptions::CheckFiles() const {
  if (has_tls()) CCST_RETURN_IF_ERROR(LoadTls(tls).status());
  if (auth_token_file.empty()) return absl::OkStatus();
  return Authenticator().UseTokens(auth_token_file, [](const std::string& /*message*/) {});
}

}  // namespace ccst::server
