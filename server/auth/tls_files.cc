#include "server/auth/tls_files.h"

#include <memory>

#include <openssl/bio.h>
#include <openssl/err.h>
#include <openssl/evp.h>
#include <openssl/pem.h>
#include <openssl/x509.h>

#include "absl/strings/str_cat.h"
#include "core/base/status.h"

namespace ccst::server {
namespace {

using Bio = std::unique_ptr<BIO, decltype(&BIO_free)>;
using Certificate = std::unique_ptr<X509, decltype(&X509_free)>;
using Key = std::unique_ptr<EVP_PKEY, decltype(&EVP_PKEY_free)>;

absl::Status Wrong(const char* flag, const char* what) {
  ERR_clear_error();
  return MakeError(absl::StatusCode::kInvalidArgument, ErrorReason::kOptionInvalid,
                   absl::StrCat(flag, " ", what));
}

absl::StatusOr<std::string> Read(const char* flag, const std::string& path) {
  auto text = ReadSmallFile(path);
  if (text.ok()) return text;
  return MakeError(text.status().code(), ErrorReason::kOptionInvalid,
                   absl::StrCat(flag, ": ", text.status().message()));
}

Bio OpenText(const std::string& text) {
  return Bio(BIO_new_mem_buf(text.data(), static_cast<int>(text.size())), BIO_free);
}

// A key that needs a passphrase is refused rather than asked for on a terminal.
int NoPassphrase(char* /*buffer*/, int /*size*/, int /*writing*/, void* /*data*/) { return -1; }

// The first of a chain, all of which are read; null when one is broken or there is none.
Certificate ReadChain(const std::string& text) {
  const Bio bio = OpenText(text);
  Certificate first(nullptr, X509_free);
  while (true) {
    Certificate next(PEM_read_bio_X509(bio.get(), nullptr, NoPassphrase, nullptr), X509_free);
    if (next == nullptr) break;
    if (first == nullptr) first = std::move(next);
  }
  // The text's end shows as a missing start line; anything else is a broken certificate.
  if (ERR_GET_REASON(ERR_peek_last_error()) != PEM_R_NO_START_LINE) first.reset();
  ERR_clear_error();
  return first;
}

}  // namespace

TlsStamps StampsOf(const TlsPaths& paths) {
  return {StampOf(paths.certificate), StampOf(paths.key), StampOf(paths.client_ca)};
}

absl::StatusOr<TlsMaterial> LoadTls(const TlsPaths& paths) {
  TlsMaterial material;
  CCST_ASSIGN_OR_RETURN(material.certificate, Read("--tls-cert", paths.certificate));
  CCST_ASSIGN_OR_RETURN(material.key, Read("--tls-key", paths.key));
  const Certificate certificate = ReadChain(material.certificate);
  if (certificate == nullptr) return Wrong("--tls-cert", "is no chain of PEM certificates");
  const Key key(
      PEM_read_bio_PrivateKey(OpenText(material.key).get(), nullptr, NoPassphrase, nullptr),
      EVP_PKEY_free);
  if (key == nullptr) return Wrong("--tls-key", "is no PEM private key without a passphrase");
  if (X509_check_private_key(certificate.get(), key.get()) != 1) {
    return Wrong("--tls-key", "is not the key of --tls-cert");
  }
  if (!paths.client_ca.empty()) {
    CCST_ASSIGN_OR_RETURN(material.client_ca, Read("--tls-client-ca", paths.client_ca));
    if (ReadChain(material.client_ca) == nullptr) {
      return Wrong("--tls-client-ca", "holds no PEM certificates");
    }
  }
  return material;
}

}  // namespace ccst::server
