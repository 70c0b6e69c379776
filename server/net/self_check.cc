#include "server/net/self_check.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <memory>
#include <string_view>
#include <utility>

#include <netinet/in.h>
#include <openssl/err.h>
#include <openssl/ssl.h>
#include <pthread.h>
#include <sys/socket.h>
#include <sys/time.h>

#include "absl/strings/str_cat.h"
#include "core/base/status.h"
#include "server/net/frame_guard.h"
#include "server/net/tls_context.h"

namespace ccst::server {
namespace {

using Context = std::unique_ptr<SSL_CTX, decltype(&SSL_CTX_free)>;

constexpr int kHeadersFrame = 1;
constexpr std::uint32_t kStream = 1;

// A field of a header block without Huffman coding or table, RFC 7541, 6.2.2; both below 127 bytes.
std::string Field(std::string_view name, std::string_view value) {
  std::string field(1, '\0');
  field += static_cast<char>(name.size());
  field += name;
  field += static_cast<char>(value.size());
  field += value;
  return field;
}

std::string Frame(int type, int flags, std::uint32_t stream, const std::string& payload) {
  std::string frame;
  for (const int shift : {16, 8, 0}) frame += static_cast<char>(payload.size() >> shift & 0xff);
  frame += static_cast<char>(type);
  frame += static_cast<char>(flags);
  for (const int shift : {24, 16, 8, 0}) frame += static_cast<char>(stream >> shift & 0xff);
  return frame + payload;
}

// A whole call of grpc.health.v1.Health/Check.
std::string HealthCall() {
  constexpr int kSettingsFrame = 4;
  constexpr int kDataFrame = 0;
  constexpr int kEndHeaders = 4;
  constexpr int kEndStream = 1;
  const std::string headers = "\x83\x86" + Field(":path", "/grpc.health.v1.Health/Check") +
                              Field(":authority", "self") +
                              Field("content-type", "application/grpc") + Field("te", "trailers");
  return "PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n" + Frame(kSettingsFrame, 0, 0, "") +
         Frame(kHeadersFrame, kEndHeaders, kStream, headers) +
         Frame(kDataFrame, kEndStream, kStream, std::string(5, '\0'));
}

absl::Status Failed(std::string_view what) {
  return absl::UnavailableError(
      absl::StrCat(absl::string_view(what.data(), what.size()), ": ", std::strerror(errno)));
}

socklen_t SizeOf(const sockaddr_storage& address) {
  return address.ss_family == AF_INET ? sizeof(sockaddr_in) : sizeof(sockaddr_in6);
}

// A socket bound to an address of the gate's machine that the gate knows as the server's own.
absl::StatusOr<FileDescriptor> Connect(ConnectionGate& gate, double seconds) {
  const sockaddr_storage& to = gate.own_address();
  FileDescriptor socket(::socket(to.ss_family, SOCK_STREAM | SOCK_CLOEXEC, 0));
  if (!socket.is_open()) return Failed("no socket");
  const timeval limit = {
      .tv_sec = static_cast<time_t>(seconds),
      .tv_usec = static_cast<suseconds_t>((seconds - std::floor(seconds)) * 1e6)};
  setsockopt(socket.get(), SOL_SOCKET, SO_RCVTIMEO, &limit, sizeof limit);
  setsockopt(socket.get(), SOL_SOCKET, SO_SNDTIMEO, &limit, sizeof limit);
  sockaddr_storage from = to;
  reinterpret_cast<sockaddr_in&>(from).sin_port = 0;  // At the same place for IPv6.
  socklen_t size = SizeOf(to);
  if (bind(socket.get(), reinterpret_cast<const sockaddr*>(&from), size) != 0 ||
      getsockname(socket.get(), reinterpret_cast<sockaddr*>(&from), &size) != 0) {
    return Failed("no port to connect from");
  }
  gate.ExpectOwn(MachineAddressOf(from));
  if (connect(socket.get(), reinterpret_cast<const sockaddr*>(&to), SizeOf(to)) != 0) {
    return Failed("no connection");
  }
  return socket;
}

// The server's certificate is not looked at: it is its own.
TlsSession StartTls(const FileDescriptor& socket) {
  const Context context(SSL_CTX_new(TLS_client_method()), SSL_CTX_free);
  TlsSession session(context == nullptr ? nullptr : SSL_new(context.get()), SSL_free);
  if (session == nullptr ||
      SSL_set_alpn_protos(session.get(), kAlpnHttp2, sizeof kAlpnHttp2) != 0 ||
      SSL_set_fd(session.get(), socket.get()) != 1 || SSL_connect(session.get()) != 1) {
    session.reset();
  }
  return session;
}

absl::Status Ask(const FileDescriptor& socket, SSL* session, double end) {
  const std::string call = HealthCall();
  const auto size = static_cast<int>(call.size());
  const bool sent = session != nullptr ? SSL_write(session, call.data(), size) == size
                                       : send(socket.get(), call.data(), call.size(),
                                              MSG_NOSIGNAL) == ssize_t{size};
  if (!sent) return Failed("nothing can be sent");
  FrameCursor cursor;
  std::array<char, 4096> room = {};
  while (EventLoop::Now() < end) {
    const ssize_t count = session != nullptr
                              ? SSL_read(session, room.data(), static_cast<int>(room.size()))
                              : recv(socket.get(), room.data(), room.size(), 0);
    if (count <= 0) return Failed("no answer");
    std::size_t at = 0;
    while (const auto head = cursor.Next({room.data(), static_cast<std::size_t>(count)}, at)) {
      if (head->type == kHeadersFrame && head->stream == kStream) return absl::OkStatus();
    }
  }
  return absl::UnavailableError("no answer in time");
}

}  // namespace

absl::Status ReachOneself(ConnectionGate& gate, double seconds) {
  const double end = EventLoop::Now() + seconds;
  errno = 0;
  absl::Status status;
  const auto socket = Connect(gate, seconds);
  if (!socket.ok()) {
    status = socket.status();
  } else if (!gate.has_tls()) {
    status = Ask(*socket, nullptr, end);
  } else {
    const TlsSession session = StartTls(*socket);
    status = session == nullptr ? Failed("no TLS") : Ask(*socket, session.get(), end);
    ERR_clear_error();
  }
  gate.ForgetOwn();
  return status;
}

SelfCheck::SelfCheck(const Options& options, std::function<absl::Status(double seconds)> reach,
                     std::function<void(const std::string& reason)> on_unreachable)
    : options_(options),
      reach_(std::move(reach)),
      on_unreachable_(std::move(on_unreachable)),
      thread_([this] { Run(); }) {}

SelfCheck::~SelfCheck() {
  {
    const MutexLock lock(mutex_);
    stopped_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void SelfCheck::Run() {
  // A connection that breaks while it is written to must not end the process.
  sigset_t broken_pipe;
  sigemptyset(&broken_pipe);
  sigaddset(&broken_pipe, SIGPIPE);
  pthread_sigmask(SIG_BLOCK, &broken_pipe, nullptr);
  const auto interval = std::chrono::duration<double>(options_.interval_seconds);
  int failures = 0;
  while (true) {
    {
      std::unique_lock lock(mutex_);
      if (changed_.wait_for(lock, interval, [this] { return stopped_; })) return;
    }
    const absl::Status status = reach_(options_.patience_seconds);
    failures = status.ok() ? 0 : failures + 1;
    if (failures < options_.failures) continue;
    on_unreachable_(std::string(status.message()));
    return;
  }
}

}  // namespace ccst::server
