#pragma once

#include <csignal>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>
#include <openssl/ssl.h>

#include "server/auth/peers.h"
#include "server/net/gate.h"
#include "tests/server/certificates.h"
#include "tests/server/net/frames.h"
#include "tests/server/temp_folder.h"

namespace ccst::server {

/// What begins a connection, up to its first request.
inline const std::string kRequest = kHttp2Preface + MakeSettings() + MakeHeaders(1, "headers");

/// A caller's end of a connection, over TLS if it has a session. Blocks, for at most 20 s.
class TestCaller {
 public:
  TestCaller() = default;
  explicit TestCaller(FileDescriptor socket);
  /// Goes on over TLS; false when the handshake failed. Without `own`, no certificate is shown.
  bool StartTls(const TestCertificate* own = nullptr);

  bool Send(const std::string& bytes);
  /// As many bytes, fewer where the connection ends.
  std::string Receive(std::size_t count);
  /// True when the connection ends without another byte.
  bool SeesTheEnd() { return Receive(1).empty(); }
  void HalfClose();
  int descriptor() const { return socket_.get(); }

 private:
  FileDescriptor socket_;
  std::shared_ptr<SSL_CTX> context_;
  std::shared_ptr<SSL> session_;
};

/// A gate on loopback, in front of a service that is a function on a thread for each connection.
class GateFixture : public testing::Test {
 protected:
  using Service = std::function<void(int socket)>;

  GateFixture() {
    std::signal(SIGPIPE, SIG_IGN);  // OpenSSL writes without asking not to be told.
    options_.listen = "127.0.0.1:0";
    options_.proxy_socket = folder_.Path("proxy.sock");
  }
  ~GateFixture() override;

  /// Opens with `options_` and accepts; connections are served by `service`.
  void Start(Service service);
  /// With a certificate for the server, and one needed of callers if so.
  void UseTls(bool of_callers);

  static FileDescriptor NewSocket();
  TestCaller Connect(FileDescriptor socket = NewSocket()) const;
  TestCaller ConnectToProxySocket() const;

  /// Waits until the condition holds; false when it does not within 20 s.
  bool Eventually(const std::function<bool()>& condition);
  std::vector<std::string> counted();
  std::vector<std::string> lines();
  /// Peers of the connections handed over so far, in their order.
  std::vector<Peer> peers_seen();

  TempFolder folder_;
  GateOptions options_;
  TestCertificate authority_;
  Peers peers_;
  std::unique_ptr<ConnectionGate> gate_;

 private:
  std::mutex mutex_;
  std::vector<std::string> counted_;
  std::vector<std::string> lines_;
  std::vector<Peer> peers_seen_;
  std::vector<std::thread> threads_;
};

/// Services.
void Echo(int socket);
void ReadToTheEnd(int socket);

}  // namespace ccst::server
