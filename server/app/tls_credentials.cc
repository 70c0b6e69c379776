#include "server/app/tls_credentials.h"

#include <mutex>
#include <optional>
#include <string>
#include <utility>

#include <grpc/grpc.h>
#include <grpc/grpc_security.h>

#include "absl/strings/str_cat.h"
#include "core/base/status.h"

namespace ccst::server {
namespace {

// gRPC asks for a configuration before every handshake and keeps the one it has unless it gets a
// new one; see server/docs/adr on why not its own watcher of files.
class WatchedTls final : public grpc::ServerCredentials {
 public:
  WatchedTls(TlsPaths paths, TlsStamps stamps, TlsMaterial first,
             std::function<void(const std::string&)> report)
      : paths_(std::move(paths)),
        report_(std::move(report)),
        stamps_(stamps),
        first_(std::move(first)),
        credentials_(grpc_ssl_server_credentials_create_with_options(
            grpc_ssl_server_credentials_create_options_using_config_fetcher(
                paths_.client_ca.empty()
                    ? GRPC_SSL_DONT_REQUEST_CLIENT_CERTIFICATE
                    : GRPC_SSL_REQUEST_AND_REQUIRE_CLIENT_CERTIFICATE_AND_VERIFY,
                [](void* self, grpc_ssl_server_certificate_config** config) {
                  return static_cast<WatchedTls*>(self)->Fetch(config);
                },
                this))) {}
  ~WatchedTls() override { grpc_server_credentials_release(credentials_); }
  WatchedTls(const WatchedTls&) = delete;
  WatchedTls& operator=(const WatchedTls&) = delete;

  // Calls authenticate themselves, see rpc/call.h.
  void SetAuthMetadataProcessor(
      const std::shared_ptr<grpc::AuthMetadataProcessor>& /*processor*/) override {}

 private:
  int AddPortToServer(const std::string& address, grpc_server* server) override {
    return grpc_server_add_http2_port(server, address.c_str(), credentials_);
  }

  grpc_ssl_certificate_config_reload_status Fetch(grpc_ssl_server_certificate_config** config) {
    const std::lock_guard lock(mutex_);
    if (first_.has_value()) {
      *config = ToConfig(*std::exchange(first_, std::nullopt));
      return GRPC_SSL_CERTIFICATE_CONFIG_RELOAD_NEW;
    }
    // Before reading: a change in between is seen at the next look.
    const TlsStamps now = StampsOf(paths_);
    if (now == stamps_) return GRPC_SSL_CERTIFICATE_CONFIG_RELOAD_UNCHANGED;
    stamps_ = now;
    const auto material = LoadTls(paths_);
    if (!material.ok()) {
      report_(absl::StrCat("certificate not reloaded, the old one stays: ",
                           material.status().message()));
      return GRPC_SSL_CERTIFICATE_CONFIG_RELOAD_UNCHANGED;
    }
    report_("certificate reloaded");
    *config = ToConfig(*material);
    return GRPC_SSL_CERTIFICATE_CONFIG_RELOAD_NEW;
  }

  static grpc_ssl_server_certificate_config* ToConfig(const TlsMaterial& material) {
    const grpc_ssl_pem_key_cert_pair pair = {.private_key = material.key.c_str(),
                                             .cert_chain = material.certificate.c_str()};
    // gRPC wants somebody to vouch for clients also where it asks for no certificate, and then does
    // not look there.
    const std::string& ca = material.client_ca.empty() ? material.certificate : material.client_ca;
    return grpc_ssl_server_certificate_config_create(ca.c_str(), &pair, 1);
  }

  const TlsPaths paths_;
  const std::function<void(const std::string&)> report_;
  std::mutex mutex_;  // Of the two below.
  TlsStamps stamps_;
  std::optional<TlsMaterial> first_;  // Checked at the start, not yet fetched.
  grpc_server_credentials* const credentials_;
};

}  // namespace

absl::StatusOr<std::shared_ptr<grpc::ServerCredentials>> WatchedTlsCredentials(
    const TlsPaths& paths, std::function<void(const std::string&)> report) {
  const TlsStamps stamps = StampsOf(paths);
  CCST_ASSIGN_OR_RETURN(TlsMaterial material, LoadTls(paths));
  return std::make_shared<WatchedTls>(paths, stamps, std::move(material), std::move(report));
}

}  // namespace ccst::server
