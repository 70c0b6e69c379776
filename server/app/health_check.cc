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
#include "absl/strings/string_view.h"
#include "absl/strings/strip.h"
#include "core/base/status.h"
#include "grpc/health/v1/health.grpc.pb.h"
#include "server/auth/tls_files.h"

namespace ccst::server {
namespace {

// Below the five seconds that container engines are told to wait.
constexpr std::chrono::seconds kTimeout(4);

// Where this machine reaches who listens on `listen`: loopback for all addresses.
std::string Reachable(absl::string_view listen) {
  if (absl::ConsumePrefix(&listen, "0.0.0.0:")) return "127.0.0.1:" + std::string(listen);
  if (absl::ConsumePrefix(&listen, "[::]:")) return "[::1]:" + std::string(listen);
  return std::string(listen);
}

absl::StatusOr<std::shared_ptr<grpc::ChannelCredentials>> Credentials(
    const SecurityOptions& security) {
  if (!security.has_tls()) return grpc::InsecureChannelCredentials();
  CCST_ASSIGN_OR_RETURN(const TlsMaterial material, LoadTls(security.tls));
  grpc::experimental::TlsChannelCredentialsOptions options;
  options.set_verify_server_certs(false);
  options.set_check_call_host(false);
  options.set_certificate_verifier(std::make_shared<grpc::experimental::NoOpCertificateVerifier>());
  options.set_certificate_provider(
      std::make_shared<grpc::experimental::StaticDataCertificateProvider>(
          std::vector<grpc::experimental::IdentityKeyCertPair>{
              {.private_key = material.key, .certificate_chain = material.certificate}}));
  if (!material.client_ca.empty()) options.watch_identity_key_cert_pairs();
  return grpc::experimental::TlsCredentials(options);
}

}  // namespace

absl::Status CheckHealth(const ServerOptions& options) {
  CCST_ASSIGN_OR_RETURN(const auto credentials, Credentials(options.security));
  const std::string address = Reachable(options.listen);
  const auto stub = grpc::health::v1::Health::NewStub(grpc::CreateChannel(address, credentials));
  grpc::ClientContext context;
  context.set_deadline(std::chrono::system_clock::now() + kTimeout);
  grpc::health::v1::HealthCheckResponse response;
  const grpc::Status status = stub->Check(&context, {}, &response);
  if (!status.ok()) {
    return absl::UnavailableError("no healthy server at " + address + ": " +
                                  status.error_message());
  }
  if (response.status() != grpc::health::v1::HealthCheckResponse::SERVING) {
    return absl::FailedPreconditionError("the server at " + address + " does not serve: it drains");
  }
  return absl::OkStatus();
}

}  // namespace ccst::server
