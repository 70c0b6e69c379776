#include "server/net/tls_context.h"

#include <utility>

#include <openssl/bio.h>
#include <openssl/err.h>
#include <openssl/pem.h>
#include <openssl/x509.h>

#include "absl/strings/str_cat.h"
#include "core/base/status.h"

namespace ccst::server {
namespace {

using Bio = std::unique_ptr<BIO, decltype(&BIO_free)>;
using Certificate = std::unique_ptr<X509, decltype(&X509_free)>;
using Key = std::unique_ptr<EVP_PKEY, decltype(&EVP_PKEY_free)>;

// Forward secret and authenticated, for TLS 1.2; those of TLS 1.3 all are.
constexpr char kCiphers[] = "ECDHE+AESGCM:ECDHE+CHACHA20";

Bio OpenText(const std::string& text) {
  return Bio(BIO_new_mem_buf(text.data(), static_cast<int>(text.size())), BIO_free);
}

Certificate ReadCertificate(BIO* bio) {
  return Certificate(PEM_read_bio_X509(bio, nullptr, nullptr, nullptr), X509_free);
}

int SelectHttp2(SSL* /*session*/, const unsigned char** chosen, unsigned char* chosen_size,
                const unsigned char* offered, unsigned int offered_size, void* /*context*/) {
  unsigned char* match = nullptr;
  if (SSL_select_next_proto(&match, chosen_size, kAlpnHttp2, sizeof kAlpnHttp2, offered,
                            offered_size) != OPENSSL_NPN_NEGOTIATED) {
    return SSL_TLSEXT_ERR_ALERT_FATAL;
  }
  *chosen = match;
  return SSL_TLSEXT_ERR_OK;
}

bool UseOwnCertificate(SSL_CTX* context, const TlsMaterial& material) {
  const Bio chain = OpenText(material.certificate);
  const Certificate own = ReadCertificate(chain.get());
  const Key key(PEM_read_bio_PrivateKey(OpenText(material.key).get(), nullptr, nullptr, nullptr),
                EVP_PKEY_free);
  if (own == nullptr || key == nullptr || SSL_CTX_use_certificate(context, own.get()) != 1 ||
      SSL_CTX_use_PrivateKey(context, key.get()) != 1) {
    return false;
  }
  while (const Certificate next = ReadCertificate(chain.get())) {
    if (SSL_CTX_add1_chain_cert(context, next.get()) != 1) return false;
  }
  ERR_clear_error();  // The end of the text shows as an error.
  return true;
}

bool AskForCertificates(SSL_CTX* context, const std::string& vouching) {
  const Bio text = OpenText(vouching);
  X509_STORE* const store = SSL_CTX_get_cert_store(context);
  while (const Certificate next = ReadCertificate(text.get())) {
    if (X509_STORE_add_cert(store, next.get()) != 1 ||
        SSL_CTX_add_client_CA(context, next.get()) != 1) {
      return false;
    }
  }
  ERR_clear_error();
  // Who is named vouches, whoever vouches for them.
  X509_STORE_set_flags(store, X509_V_FLAG_PARTIAL_CHAIN | X509_V_FLAG_TRUSTED_FIRST);
  SSL_CTX_set_verify(context, SSL_VERIFY_PEER | SSL_VERIFY_FAIL_IF_NO_PEER_CERT, nullptr);
  return true;
}

}  // namespace

absl::StatusOr<TlsContext::Context> TlsContext::Make(const TlsMaterial& material) {
  Context context(SSL_CTX_new(TLS_server_method()), SSL_CTX_free);
  const bool is_whole =
      context != nullptr && SSL_CTX_set_min_proto_version(context.get(), TLS1_2_VERSION) == 1 &&
      SSL_CTX_set_cipher_list(context.get(), kCiphers) == 1 &&
      UseOwnCertificate(context.get(), material) &&
      (material.client_ca.empty() || AskForCertificates(context.get(), material.client_ca));
  if (!is_whole) {
    ERR_clear_error();
    return MakeError(absl::StatusCode::kInvalidArgument, ErrorReason::kOptionInvalid,
                     "--tls-cert, --tls-key or --tls-client-ca cannot be used; a key of 2048 bits "
                     "for RSA or 256 for elliptic curves would be right");
  }
  SSL_CTX_set_options(context.get(), SSL_OP_NO_RENEGOTIATION | SSL_OP_NO_COMPRESSION |
                                         SSL_OP_NO_TICKET | SSL_OP_CIPHER_SERVER_PREFERENCE);
  SSL_CTX_set_session_cache_mode(context.get(), SSL_SESS_CACHE_OFF);
  SSL_CTX_set_num_tickets(context.get(), 0);
  SSL_CTX_set_mode(context.get(), SSL_MODE_ENABLE_PARTIAL_WRITE |
                                      SSL_MODE_ACCEPT_MOVING_WRITE_BUFFER |
                                      SSL_MODE_RELEASE_BUFFERS);
  // One record at a time: a client that sends nothing but key updates gets no more than its turn.
  SSL_CTX_clear_mode(context.get(), SSL_MODE_AUTO_RETRY);
  SSL_CTX_set_alpn_select_cb(context.get(), SelectHttp2, nullptr);
  return context;
}

absl::StatusOr<std::unique_ptr<TlsContext>> TlsContext::Load(
    const TlsPaths& paths, std::function<void(const std::string&)> report) {
  // Before reading: a change in between is seen at the next look.
  const TlsStamps stamps = StampsOf(paths);
  CCST_ASSIGN_OR_RETURN(const TlsMaterial material, LoadTls(paths));
  auto context = Make(material);
  if (!context.ok()) return context.status();
  return std::unique_ptr<TlsContext>(
      new TlsContext(paths, stamps, *std::move(context), std::move(report)));
}

TlsContext::TlsContext(TlsPaths paths, TlsStamps stamps, Context context,
                       std::function<void(const std::string&)> report)
    : paths_(std::move(paths)),
      report_(std::move(report)),
      stamps_(stamps),
      context_(std::move(context)) {}

void TlsContext::ReloadIfChanged() {
  const TlsStamps now = StampsOf(paths_);
  if (now == stamps_) return;
  stamps_ = now;
  const auto material = LoadTls(paths_);
  auto context = material.ok() ? Make(*material) : material.status();
  if (!context.ok()) {
    report_(
        absl::StrCat("certificate not reloaded, the old one stays: ", context.status().message()));
    return;
  }
  context_ = *std::move(context);
  report_("certificate reloaded");
}

TlsSession TlsContext::NewSession(bool from_here) {
  ReloadIfChanged();
  TlsSession session(SSL_new(context_.get()), SSL_free);
  if (session == nullptr) return session;
  SSL_set_accept_state(session.get());
  if (from_here) SSL_set_verify(session.get(), SSL_VERIFY_NONE, nullptr);
  return session;
}

}  // namespace ccst::server
