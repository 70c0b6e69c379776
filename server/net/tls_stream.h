#pragma once

#include <optional>
#include <string>

#include "absl/status/statusor.h"
#include "server/auth/certificate_identity.h"
#include "server/net/byte_stream.h"
#include "server/net/tls_context.h"

namespace ccst::server {

/// A socket with TLS over it. Not thread-safe, but may go from one thread to another.
class TlsStream final : public ByteStream {
 public:
  TlsStream(FileDescriptor socket, TlsSession session);

  /// What a handshake waits for.
  enum class Wait { kNothing, kRead, kWrite };

  /// Goes on with the handshake; kNothing once it is done.
  /// @errors UNAUTHENTICATED  it failed; says why, in words of OpenSSL alone
  absl::StatusOr<Wait> Handshake();

  /// Whom the client's certificate names; none when it showed none.
  std::optional<absl::StatusOr<CertificateIdentity>> identity() const;

  Transfer Read(std::span<char> room) override;
  Transfer Write(std::span<const char> bytes) override;
  bool HasBuffered() const override;
  bool ReadWaitsToWrite() const override { return read_waits_to_write_; }
  void FinishWriting() override;

 private:
  Transfer Result(int count, int result);

  TlsSession session_;
  bool read_waits_to_write_ = false;
};

}  // namespace ccst::server
