#include "server/net/arrival.h"

#include <cerrno>
#include <utility>

#include <sys/epoll.h>
#include <sys/socket.h>

#include "core/base/status.h"
#include "server/net/proxy_header.h"

namespace ccst::server {
namespace {

// After a recv() that gave nothing: what to wait for.
absl::StatusOr<std::uint32_t> WaitToRead(ssize_t count) {
  if (count < 0 && (errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR)) return EPOLLIN;
  return absl::CancelledError("it went away");
}

}  // namespace

void Arrival::Begin(EventLoop& loop, Connection connection, TlsContext* tls, double seconds,
                    Done done) {
  const std::shared_ptr<Arrival> arrival(
      new Arrival(loop, std::move(connection), tls, std::move(done)));
  arrival->watch_ = loop.Watch(arrival->connection_.socket.get(), 0,
                               [arrival](std::uint32_t /*events*/) { arrival->GoOn(); });
  arrival->timer_ = loop.RunAt(EventLoop::Now() + seconds, [arrival] {
    arrival->End(absl::DeadlineExceededError("it did not say in time who it is"));
  });
  arrival->GoOn();
}

Arrival::Arrival(EventLoop& loop, Connection connection, TlsContext* tls, Done done)
    : loop_(loop), connection_(std::move(connection)), tls_(tls), done_(std::move(done)) {}

void Arrival::GoOn() {
  const auto events = Step();
  if (!events.ok()) {
    End(events.status());
  } else if (*events != 0) {
    loop_.Change(watch_, *events);
  } else {
    Caller caller;
    caller.peer = {.address = connection_.address.text,
                   .certificate = tls_stream_ != nullptr ? tls_stream_->identity() : std::nullopt,
                   .vouched_by_proxy = connection_.from_proxy && tls_ == nullptr};
    caller.place = std::move(connection_.place);
    if (tls_stream_ != nullptr) {
      caller.stream = std::move(tls_stream_);
    } else {
      caller.stream = std::make_unique<ByteStream>(std::move(connection_.socket));
    }
    End(std::move(caller));
  }
}

absl::StatusOr<std::uint32_t> Arrival::Step() {
  if (!has_address_) {
    if (connection_.from_proxy) {
      CCST_ASSIGN_OR_RETURN(const std::uint32_t events, ReadProxyHeader());
      if (events != 0) return events;
    }
    has_address_ = true;
    if (!connection_.from_here) {
      CCST_RETURN_IF_ERROR(
          connection_.place->Charge(connection_.address.network, EventLoop::Now()));
    }
  }
  if (tls_ == nullptr) return 0;
  return Handshake();
}

// Reads not a byte more than the header: what follows is for TLS or HTTP/2.
absl::StatusOr<std::uint32_t> Arrival::ReadProxyHeader() {
  const int socket = connection_.socket.get();
  if (header_.empty()) {
    char first = 0;
    const ssize_t count = recv(socket, &first, 1, MSG_PEEK);
    if (count <= 0) return WaitToRead(count);
    // Not every connection is a caller's: this machine's own have no header.
    if (first != kProxyHeaderFirstByte) return 0;
  }
  std::size_t wanted = kProxyHeaderStart;
  while (true) {
    if (header_.size() >= kProxyHeaderStart) {
      CCST_ASSIGN_OR_RETURN(const std::size_t rest,
                            ProxyHeaderRest({header_.data(), kProxyHeaderStart}));
      wanted = kProxyHeaderStart + rest;
    }
    if (header_.size() == wanted) break;
    const std::size_t begin = header_.size();
    header_.resize(wanted);
    const ssize_t count = recv(socket, &header_[begin], wanted - begin, 0);
    header_.resize(begin + (count > 0 ? static_cast<std::size_t>(count) : 0));
    if (count <= 0) return WaitToRead(count);
  }
  CCST_ASSIGN_OR_RETURN(connection_.address, ParseProxyHeader(header_));
  return 0;
}

absl::StatusOr<std::uint32_t> Arrival::Handshake() {
  if (tls_stream_ == nullptr) {
    TlsSession session = tls_->NewSession(connection_.from_here);
    if (session == nullptr) return absl::ResourceExhaustedError("memory is short");
    // The stream owns the socket from here on; the loop goes on watching it.
    tls_stream_ = std::make_unique<TlsStream>(std::move(connection_.socket), std::move(session));
  }
  CCST_ASSIGN_OR_RETURN(const TlsStream::Wait wait, tls_stream_->Handshake());
  if (wait == TlsStream::Wait::kNothing) return 0;
  return wait == TlsStream::Wait::kRead ? EPOLLIN : EPOLLOUT;
}

void Arrival::End(absl::StatusOr<Caller> result) {
  if (!done_) return;
  const std::shared_ptr<Arrival> self = shared_from_this();
  loop_.Forget(watch_);
  loop_.Cancel(timer_);
  std::exchange(done_, nullptr)(std::move(result));
}

}  // namespace ccst::server
