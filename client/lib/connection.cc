#include "client/lib/connection.h"

#include <algorithm>
#include <utility>
#include <vector>

#include <grpcpp/create_channel.h>
#include <grpcpp/security/credentials.h>
#include <grpcpp/support/client_interceptor.h>

#include "absl/strings/ascii.h"
#include "core/base/loopback.h"
#include "core/base/status.h"

namespace ccst {
namespace {

constexpr int kKeepaliveMs = 30'000;
constexpr int kMaxReconnectMs = 2'000;
// Half of the metadata that gRPC takes by default.
constexpr std::size_t kMaxTokenBytes = 4096;

absl::Status Wrong(const std::string& message) {
  return MakeError(absl::StatusCode::kInvalidArgument, ErrorReason::kOptionInvalid, message);
}

absl::Status Check(const Connection& connection) {
  // gRPC ends the process over metadata that HTTP/2 cannot carry.
  if (!IsToken(connection.token)) {
    return Wrong("the connection " + std::string(kTokenForm));
  }
  if (connection.certificate.empty() != connection.key.empty()) {
    return Wrong("a client certificate needs its key, and a key its certificate");
  }
  if (!connection.certificate.empty() && connection.ca.empty()) {
    return Wrong("a client certificate needs TLS; say with --tls-ca who vouches for the server");
  }
  if (!connection.token.empty() && connection.ca.empty() && !connection.insecure &&
      !IsLoopback(connection.address)) {
    return Wrong("the token is not sent unencrypted to " + connection.address +
                 "; say with --tls-ca who vouches for the server, or accept it with --insecure");
  }
  return absl::OkStatus();
}

// Adds the token to every call. Not call credentials: gRPC sends those over TLS alone, and a server
// on this machine may have none.
class TokenInterceptor final : public grpc::experimental::Interceptor {
 public:
  explicit TokenInterceptor(const std::string& token) : token_(token) {}

  void Intercept(grpc::experimental::InterceptorBatchMethods* methods) override {
    using grpc::experimental::InterceptionHookPoints;
    if (methods->QueryInterceptionHookPoint(InterceptionHookPoints::PRE_SEND_INITIAL_METADATA)) {
      methods->GetSendInitialMetadata()->insert({"authorization", "Bearer " + token_});
    }
    methods->Proceed();
  }

 private:
  const std::string& token_;  // The factory's, which lives as long as the channel.
};

class TokenInterceptorFactory final : public grpc::experimental::ClientInterceptorFactoryInterface {
 public:
  explicit TokenInterceptorFactory(std::string token) : token_(std::move(token)) {}

  grpc::experimental::Interceptor* CreateClientInterceptor(
      grpc::experimental::ClientRpcInfo* /*info*/) override {
    return new TokenInterceptor(token_);
  }

 private:
  const std::string token_;
};

std::shared_ptr<grpc::ChannelCredentials> Credentials(const Connection& connection) {
  if (connection.ca.empty()) return grpc::InsecureChannelCredentials();
  grpc::SslCredentialsOptions options;
  options.pem_root_certs = connection.ca;
  options.pem_private_key = connection.key;
  options.pem_cert_chain = connection.certificate;
  return grpc::SslCredentials(options);
}

}  // namespace

bool IsToken(std::string_view text) {
  return text.size() <= kMaxTokenBytes && std::all_of(text.begin(), text.end(), [](char c) {
           return absl::ascii_isgraph(static_cast<unsigned char>(c));
         });
}

absl::StatusOr<std::shared_ptr<grpc::Channel>> OpenChannel(const Connection& connection) {
  CCST_RETURN_IF_ERROR(Check(connection));
  grpc::ChannelArguments arguments;
  // A proxy for web pages is no way to a computation server.
  arguments.SetInt(GRPC_ARG_ENABLE_HTTP_PROXY, 0);
  // A machine that vanishes says no goodbye. Servers take pings from every 10 s on.
  arguments.SetInt(GRPC_ARG_KEEPALIVE_TIME_MS, kKeepaliveMs);
  arguments.SetInt(GRPC_ARG_KEEPALIVE_TIMEOUT_MS, kKeepaliveMs);
  // So that each attempt really tries to connect.
  arguments.SetInt(GRPC_ARG_INITIAL_RECONNECT_BACKOFF_MS, 100);
  arguments.SetInt(GRPC_ARG_MAX_RECONNECT_BACKOFF_MS, kMaxReconnectMs);
  std::vector<std::unique_ptr<grpc::experimental::ClientInterceptorFactoryInterface>> interceptors;
  if (!connection.token.empty()) {
    interceptors.push_back(std::make_unique<TokenInterceptorFactory>(connection.token));
  }
  return grpc::experimental::CreateCustomChannelWithInterceptors(
      connection.address, Credentials(connection), arguments, std::move(interceptors));
}

}  // namespace ccst
