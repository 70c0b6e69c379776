#include "tests/server/certificates.h"

#include <memory>
#include <stdexcept>

#include <openssl/bio.h>
#include <openssl/evp.h>
#include <openssl/pem.h>
#include <openssl/rand.h>
#include <openssl/x509.h>
#include <openssl/x509v3.h>

namespace ccst::server {
namespace {

using Bio = std::unique_ptr<BIO, decltype(&BIO_free)>;
using Certificate = std::unique_ptr<X509, decltype(&X509_free)>;
using Key = std::unique_ptr<EVP_PKEY, decltype(&EVP_PKEY_free)>;

constexpr long kMinute = 60;
constexpr int kVersion3 = 2;

void Check(bool ok) {
  if (!ok) throw std::runtime_error("OpenSSL failed");
}

Bio Input(const std::string& text) {
  return Bio(BIO_new_mem_buf(text.data(), static_cast<int>(text.size())), BIO_free);
}

std::string Text(BIO* bio) {
  char* data = nullptr;
  const long size = BIO_get_mem_data(bio, &data);
  return std::string(data, static_cast<std::size_t>(size));
}

TestCertificate ToPem(X509* certificate, EVP_PKEY* key) {
  const Bio certificate_text(BIO_new(BIO_s_mem()), BIO_free);
  const Bio key_text(BIO_new(BIO_s_mem()), BIO_free);
  Check(PEM_write_bio_X509(certificate_text.get(), certificate) == 1);
  Check(PEM_write_bio_PrivateKey(key_text.get(), key, nullptr, nullptr, 0, nullptr, nullptr) == 1);
  return {.certificate = Text(certificate_text.get()), .key = Text(key_text.get())};
}

void AddExtension(X509* certificate, X509* issuer, int id, const char* value) {
  X509V3_CTX context;
  X509V3_set_ctx(&context, issuer, certificate, nullptr, nullptr, 0);
  X509_EXTENSION* extension = X509V3_EXT_conf_nid(nullptr, &context, id, value);
  Check(extension != nullptr && X509_add_ext(certificate, extension, -1) == 1);
  X509_EXTENSION_free(extension);
}

void AddAttribute(const TestAttribute& attribute, X509_NAME* name) {
  const int kind = attribute.kind == 0 ? V_ASN1_UTF8STRING : attribute.kind;
  const auto* bytes = reinterpret_cast<const unsigned char*>(attribute.value.data());
  Check(X509_NAME_add_entry_by_txt(name, attribute.type.c_str(), kind, bytes,
                                   static_cast<int>(attribute.value.size()), -1,
                                   attribute.beside ? -1 : 0) == 1);
}

// All but extensions and signature.
Certificate Unsigned(const std::vector<TestAttribute>& subject, EVP_PKEY* key) {
  Certificate certificate(X509_new(), X509_free);
  std::uint64_t serial = 0;
  Check(RAND_bytes(reinterpret_cast<unsigned char*>(&serial), sizeof serial) == 1);
  Check(X509_set_version(certificate.get(), kVersion3) == 1);
  ASN1_INTEGER_set_uint64(X509_get_serialNumber(certificate.get()), serial >> 1);
  X509_gmtime_adj(X509_getm_notBefore(certificate.get()), -kMinute);
  X509_gmtime_adj(X509_getm_notAfter(certificate.get()), 60 * kMinute);
  for (const TestAttribute& attribute : subject) {
    AddAttribute(attribute, X509_get_subject_name(certificate.get()));
  }
  Check(X509_set_pubkey(certificate.get(), key) == 1);
  return certificate;
}

}  // namespace

TestCertificate MakeAuthority(const std::string& name) {
  const Key key(EVP_EC_gen("P-256"), EVP_PKEY_free);
  const Certificate certificate = Unsigned({{.type = "CN", .value = name}}, key.get());
  X509_set_issuer_name(certificate.get(), X509_get_subject_name(certificate.get()));
  AddExtension(certificate.get(), certificate.get(), NID_basic_constraints, "critical,CA:TRUE");
  AddExtension(certificate.get(), certificate.get(), NID_key_usage, "critical,keyCertSign");
  Check(X509_sign(certificate.get(), key.get(), EVP_sha256()) > 0);
  return ToPem(certificate.get(), key.get());
}

TestCertificate MakeCertificate(const TestCertificate& authority, const std::string& name) {
  return MakeCertificateOf(authority,
                           {.subject = {{.type = "CN", .value = name}},
                            .alternatives = "DNS:" + name + ",DNS:localhost,IP:127.0.0.1"});
}

std::string DerOf(const TestCertificate& certificate) {
  const Certificate read(
      PEM_read_bio_X509(Input(certificate.certificate).get(), nullptr, nullptr, nullptr),
      X509_free);
  unsigned char* der = nullptr;
  const int size = i2d_X509(read.get(), &der);
  Check(size > 0);
  std::string bytes(reinterpret_cast<const char*>(der), static_cast<std::size_t>(size));
  OPENSSL_free(der);
  return bytes;
}

TestCertificate MakeCertificateOf(const TestCertificate& authority, const TestNames& names) {
  const Certificate issuer(
      PEM_read_bio_X509(Input(authority.certificate).get(), nullptr, nullptr, nullptr), X509_free);
  const Key issuer_key(
      PEM_read_bio_PrivateKey(Input(authority.key).get(), nullptr, nullptr, nullptr),
      EVP_PKEY_free);
  const Key key(EVP_EC_gen("P-256"), EVP_PKEY_free);
  const Certificate certificate = Unsigned(names.subject, key.get());
  X509_set_issuer_name(certificate.get(), X509_get_subject_name(issuer.get()));
  if (!names.alternatives.empty()) {
    AddExtension(certificate.get(), issuer.get(), NID_subject_alt_name, names.alternatives.c_str());
  }
  Check(X509_sign(certificate.get(), issuer_key.get(), EVP_sha256()) > 0);
  return ToPem(certificate.get(), key.get());
}

}  // namespace ccst::server
