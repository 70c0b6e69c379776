#include "server/app/health_check.h"

#include <chrono>
#include <memory>
#include <string>
#include <vector>

#include <grpcpp/create_channel.h>
#include <grpcpp/security/credentials.h>
#include <grpcpp/security/tls_certificate_provider.h>
#include <grpcpp/security/tls_credentials_options.h>

#include "absl/status/statusor.h"
#include "absl/strings/str_replace.h"
#include "core/base/status.h"
#include "grpc/health/v1/health.grpc.pb.h"
#include "server/app/listen_address.h"
#include "server/auth/tls_files.h"

namespace ccst::server {
namespace {

// Below the five seconds that container engines are told to wait.
constexpr std::chrono::seconds kTimeout(4);

// Where this machine reaches who listens on `listen`: loopback for all addresses.
absl::StatusOr<std::string> Reachable(const std::string& listen) {
  CCST_ASSIGN_OR_RETURN(ListenAddress address, ParseListenAddress(listen));
  if (address.port == 0) {
    return MakeError(absl::StatusCode::kInvalidArgument, ErrorReason::kOptionInvalid,
                     "--health needs the port that the server has: --listen says 0, which is any");
  }
  if (address.is_any()) address.host = address.is_ipv6 ? "::1" : "127.0.0.1";
  return address.ToText();
}

absl::StatusOr<std::shared_ptr<grpc::ChannelCredentials>> Credentials(
    const SecurityOptions& security) {
  if (!security.has_tls()) return grpc::InsecureChannelCredentials();
  TlsPaths shown = security.tls;
  if (!security.health_cert.empty()) {
    shown.certificate = security.health_cert;
    shown.key = security.health_key;
  }
  const auto material = LoadTls(shown);
  if (!material.ok() && !security.health_cert.empty()) {
    return MakeError(
        material.status().code(), ErrorReason::kOptionInvalid,
        absl::StrReplaceAll(material.status().message(),
                            {{"--tls-cert", "--health-cert"}, {"--tls-key", "--health-key"}}));
  }
  CCST_RETURN_IF_ERROR(material.status());
  grpc::experimental::TlsChannelCredentialsOptions options;
  options.set_verify_server_certs(false);
  options.set_check_call_host(false);
  options.set_certificate_verifier(std::make_shared<grpc::experimental::NoOpCertificateVerifier>());
  options.set_certificate_provider(
      std::make_shared<grpc::experimental::StaticDataCertificateProvider>(
          std::vector<grpc::experimental::IdentityKeyCertPair>{
              {.private_key = material->key, .certificate_chain = material->certificate}}));
  if (!material->client_ca.empty()) options.watch_identity_key_cert_pairs();
  return grpc::experimental::TlsCredentials(options);
}

}  // namespace

absl::Status CheckHealth(const ServerOptions& options) {
  CCST_ASSIGN_OR_RETURN(const auto credentials, Credentials(options.security));
  CCST_ASSIGN_OR_RETURN(const std::string address, Reachable(options.listen));
  grpc::ChannelArguments arguments;
  // The environment's proxies are for other machines.
  arguments.SetInt(GRPC_ARG_ENABLE_HTTP_PROXY, 0);
  const auto stub =
      grpc::health::v1::Health::NewStub(grpc::CreateCustomChannel(address, credentials, arguments));
  grpc::ClientContext context;
  context.set_deadline(std::chrono::system_clock::now() + kTimeout);
  grpc::health::v1::HealthCheckResponse response;
  const grpc::Status status = stub->Check(&context, {}, &response);
  if (!status.ok()) {
    const std::string hint =
        options.security.tls.client_ca.empty()
            ? ""
            : "; callers need a certificate that is good for clients and that --tls-client-ca "
              "vouches for: name one with --health-cert where the server's own is none";
    return absl::UnavailableError("no healthy server at " + address + ": " +
                                  status.error_message() + hint);
  }
  if (response.status() != grpc::health::v1::HealthCheckResponse::SERVING) {
    return absl::FailedPreconditionError("the server at " + address + " does not serve: it drains");
  }
  return absl::OkStatus();
}

}  // namespace ccst::server
