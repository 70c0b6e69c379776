#include "server/net/tls_stream.h"

#include <algorithm>
#include <climits>
#include <memory>
#include <utility>

#include <openssl/err.h>
#include <openssl/x509.h>

#include "absl/strings/str_cat.h"

namespace ccst::server {
namespace {

int Clamped(std::size_t size) { return static_cast<int>(std::min<std::size_t>(size, INT_MAX)); }

std::string ReasonOfFailure() {
  const char* reason = ERR_reason_error_string(ERR_peek_last_error());
  std::string text = reason != nullptr ? reason : "the client went away";
  ERR_clear_error();
  return text;
}

}  // namespace

TlsStream::TlsStream(FileDescriptor socket, TlsSession session)
    : ByteStream(std::move(socket)), session_(std::move(session)) {
  SSL_set_fd(session_.get(), descriptor());
}

absl::StatusOr<TlsStream::Wait> TlsStream::Handshake() {
  ERR_clear_error();
  const int result = SSL_do_handshake(session_.get());
  if (result == 1) {
    const unsigned char* protocol = nullptr;
    unsigned int size = 0;
    SSL_get0_alpn_selected(session_.get(), &protocol, &size);
    if (size == 0) return absl::UnauthenticatedError("the client does not offer HTTP/2");
    return Wait::kNothing;
  }
  switch (SSL_get_error(session_.get(), result)) {
    case SSL_ERROR_WANT_READ:
      return Wait::kRead;
    case SSL_ERROR_WANT_WRITE:
      return Wait::kWrite;
    default:
      return absl::UnauthenticatedError(ReasonOfFailure());
  }
}

std::optional<absl::StatusOr<CertificateIdentity>> TlsStream::identity() const {
  const std::unique_ptr<X509, decltype(&X509_free)> certificate(
      SSL_get1_peer_certificate(session_.get()), X509_free);
  if (certificate == nullptr || SSL_get_verify_result(session_.get()) != X509_V_OK) {
    return std::nullopt;
  }
  unsigned char* der = nullptr;
  const int size = i2d_X509(certificate.get(), &der);
  if (size <= 0) return IdentifyCertificate("");
  auto identity =
      IdentifyCertificate({reinterpret_cast<const char*>(der), static_cast<std::size_t>(size)});
  OPENSSL_free(der);
  return identity;
}

Transfer TlsStream::Result(int count, int result) {
  if (count > 0) {
    return {.state = Transfer::State::kSome, .bytes = static_cast<std::size_t>(count)};
  }
  switch (result) {
    case SSL_ERROR_WANT_READ:
    case SSL_ERROR_WANT_WRITE:
      return {.state = Transfer::State::kWait};
    case SSL_ERROR_ZERO_RETURN:
      return {.state = Transfer::State::kEnded};
    default:
      ERR_clear_error();
      return {.state = Transfer::State::kBroken};
  }
}

Transfer TlsStream::Read(std::span<char> room) {
  ERR_clear_error();
  const int count = SSL_read(session_.get(), room.data(), Clamped(room.size()));
  const int result = SSL_get_error(session_.get(), count);
  read_waits_to_write_ = count <= 0 && result == SSL_ERROR_WANT_WRITE;
  return Result(count, result);
}

Transfer TlsStream::Write(std::span<const char> bytes) {
  ERR_clear_error();
  const int count = SSL_write(session_.get(), bytes.data(), Clamped(bytes.size()));
  return Result(count, SSL_get_error(session_.get(), count));
}

bool TlsStream::HasBuffered() const { return SSL_pending(session_.get()) > 0; }

void TlsStream::FinishWriting() {
  SSL_shutdown(session_.get());
  ERR_clear_error();
  ByteStream::FinishWriting();
}

}  // namespace ccst::server
