#include "tests/server/net/gate_fixture.h"

#include <array>
#include <chrono>
#include <cstring>

#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <openssl/bio.h>
#include <openssl/pem.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <sys/un.h>

namespace ccst::server {
namespace {

constexpr int kSeconds = 20;
constexpr unsigned char kHttp2[] = {2, 'h', '2'};

void SetPatience(int socket) {
  const timeval limit = {.tv_sec = kSeconds, .tv_usec = 0};
  setsockopt(socket, SOL_SOCKET, SO_RCVTIMEO, &limit, sizeof limit);
  setsockopt(socket, SOL_SOCKET, SO_SNDTIMEO, &limit, sizeof limit);
}

std::shared_ptr<BIO> Text(const std::string& text) {
  return {BIO_new_mem_buf(text.data(), static_cast<int>(text.size())), BIO_free};
}

}  // namespace

TestCaller::TestCaller(FileDescriptor socket) : socket_(std::move(socket)) {
  SetPatience(socket_.get());
}

bool TestCaller::StartTls(const TestCertificate* own) {
  context_ = {SSL_CTX_new(TLS_client_method()), SSL_CTX_free};
  if (own != nullptr) {
    const std::shared_ptr<X509> certificate(
        PEM_read_bio_X509(Text(own->certificate).get(), nullptr, nullptr, nullptr), X509_free);
    const std::shared_ptr<EVP_PKEY> key(
        PEM_read_bio_PrivateKey(Text(own->key).get(), nullptr, nullptr, nullptr), EVP_PKEY_free);
    SSL_CTX_use_certificate(context_.get(), certificate.get());
    SSL_CTX_use_PrivateKey(context_.get(), key.get());
  }
  session_ = {SSL_new(context_.get()), SSL_free};
  SSL_set_alpn_protos(session_.get(), kHttp2, sizeof kHttp2);
  SSL_set_fd(session_.get(), socket_.get());
  return SSL_connect(session_.get()) == 1;
}

bool TestCaller::Send(const std::string& bytes) {
  std::size_t sent = 0;
  while (sent < bytes.size()) {
    const auto left = bytes.size() - sent;
    const ssize_t count = session_ != nullptr
                              ? SSL_write(session_.get(), &bytes[sent], static_cast<int>(left))
                              : send(socket_.get(), &bytes[sent], left, MSG_NOSIGNAL);
    if (count <= 0) return false;
    sent += static_cast<std::size_t>(count);
  }
  return true;
}

std::string TestCaller::Receive(std::size_t count) {
  std::string bytes(count, '\0');
  std::size_t received = 0;
  while (received < count) {
    const auto left = count - received;
    const ssize_t some = session_ != nullptr
                             ? SSL_read(session_.get(), &bytes[received], static_cast<int>(left))
                             : recv(socket_.get(), &bytes[received], left, 0);
    if (some <= 0) break;
    received += static_cast<std::size_t>(some);
  }
  bytes.resize(received);
  return bytes;
}

void TestCaller::HalfClose() { shutdown(socket_.get(), SHUT_WR); }

GateFixture::~GateFixture() {
  gate_.reset();
  for (std::thread& thread : threads_) thread.join();
}

void GateFixture::Start(Service service) {
  auto gate = ConnectionGate::Open(
      options_, {.peers = peers_,
                 .hand_over =
                     [this, service](int socket) {
                       sockaddr_un name = {};
                       socklen_t size = sizeof name;
                       getpeername(socket, reinterpret_cast<sockaddr*>(&name), &size);
                       const auto length = size - offsetof(sockaddr_un, sun_path) - 1;
                       const auto peer = peers_.Find({&name.sun_path[1], length});
                       const std::lock_guard lock(mutex_);
                       peers_seen_.push_back(peer == nullptr ? Peer{.address = "unknown"} : *peer);
                       fcntl(socket, F_SETFL, fcntl(socket, F_GETFL) & ~O_NONBLOCK);
                       threads_.emplace_back([socket, service] {
                         service(socket);
                         close(socket);
                       });
                       return true;
                     },
                 .count =
                     [this](std::string_view reason) {
                       const std::lock_guard lock(mutex_);
                       counted_.emplace_back(reason);
                     },
                 .report =
                     [this](const std::string& line) {
                       const std::lock_guard lock(mutex_);
                       lines_.push_back(line);
                     }});
  ASSERT_TRUE(gate.ok()) << gate.status();
  gate_ = *std::move(gate);
  gate_->Accept();
}

void GateFixture::UseTls(bool of_callers) {
  authority_ = MakeAuthority("authority");
  const TestCertificate own = MakeCertificate(authority_, "server");
  options_.tls.certificate = folder_.Write("cert", own.certificate);
  options_.tls.key = folder_.Write("key", own.key);
  if (of_callers) options_.tls.client_ca = folder_.Write("ca", authority_.certificate);
}

FileDescriptor GateFixture::NewSocket() {
  return FileDescriptor(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
}

TestCaller GateFixture::Connect(FileDescriptor socket) const {
  sockaddr_in place = {};
  place.sin_family = AF_INET;
  const std::string& address = gate_->address();
  place.sin_port =
      htons(static_cast<std::uint16_t>(std::stoi(address.substr(address.rfind(':') + 1))));
  inet_pton(AF_INET, "127.0.0.1", &place.sin_addr);
  EXPECT_EQ(connect(socket.get(), reinterpret_cast<sockaddr*>(&place), sizeof place), 0);
  return TestCaller(std::move(socket));
}

TestCaller GateFixture::ConnectToProxySocket() const {
  sockaddr_un place = {};
  place.sun_family = AF_UNIX;
  std::strncpy(place.sun_path, options_.proxy_socket.c_str(), sizeof place.sun_path - 1);
  FileDescriptor socket(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0));
  EXPECT_EQ(connect(socket.get(), reinterpret_cast<sockaddr*>(&place), sizeof place), 0);
  return TestCaller(std::move(socket));
}

bool GateFixture::Eventually(const std::function<bool()>& condition) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(kSeconds);
  while (!condition()) {
    if (std::chrono::steady_clock::now() > end) return false;
    std::this_thread::yield();
  }
  return true;
}

std::vector<std::string> GateFixture::counted() {
  const std::lock_guard lock(mutex_);
  return counted_;
}

std::vector<std::string> GateFixture::lines() {
  const std::lock_guard lock(mutex_);
  return lines_;
}

std::vector<Peer> GateFixture::peers_seen() {
  const std::lock_guard lock(mutex_);
  return peers_seen_;
}

void Echo(int socket) {
  std::array<char, 1 << 16> room = {};
  while (true) {
    const ssize_t count = recv(socket, room.data(), room.size(), 0);
    if (count <= 0) return;
    for (ssize_t sent = 0; sent < count;) {
      const ssize_t some = send(socket, &room[static_cast<std::size_t>(sent)],
                                static_cast<std::size_t>(count - sent), MSG_NOSIGNAL);
      if (some <= 0) return;
      sent += some;
    }
  }
}

void ReadToTheEnd(int socket) {
  std::array<char, 1 << 16> room = {};
  while (recv(socket, room.data(), room.size(), 0) > 0) {
  }
}

}  // namespace ccst::server
