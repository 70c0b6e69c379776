#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "server/auth/peer.h"
#include "server/net/byte_stream.h"
#include "server/net/connection_limits.h"
#include "server/net/event_loop.h"
#include "server/net/machine_address.h"
#include "server/net/tls_context.h"
#include "server/net/tls_stream.h"

namespace ccst::server {

/// A connection from its acceptance until it is known who it is: what a proxy says of it and its
/// TLS handshake, within a time. For the thread of its loop alone.
class Arrival : public std::enable_shared_from_this<Arrival> {
 public:
  struct Connection {
    FileDescriptor socket;
    MachineAddress address;
    std::unique_ptr<ConnectionLimits::Place> place;
    bool from_proxy = false;  ///< A proxy that is trusted may say for whom it comes.
    bool from_here = false;   ///< The server's own, which looks whether it can be reached.
  };
  /// What comes of it.
  struct Caller {
    std::unique_ptr<ByteStream> stream;
    Peer peer;
    std::unique_ptr<ConnectionLimits::Place> place;
  };
  using Done = std::function<void(absl::StatusOr<Caller>)>;

  /// @param tls   null for none; outlives this.
  /// @param done  called once, unless the loop ends before.
  ///              @errors RESOURCE_EXHAUSTED  the address has too many connections
  ///                      INVALID_ARGUMENT    the proxy's words are broken
  ///                      UNAUTHENTICATED     the handshake failed
  ///                      DEADLINE_EXCEEDED   it took longer than `seconds`
  ///                      CANCELLED           the client went away before it said anything
  static void Begin(EventLoop& loop, Connection connection, TlsContext* tls, double seconds,
                    Done done);

 private:
  Arrival(EventLoop& loop, Connection connection, TlsContext* tls, Done done);
  void GoOn();
  // Both: what to wait for, or 0 when that step is done.
  absl::StatusOr<std::uint32_t> ReadProxyHeader();
  absl::StatusOr<std::uint32_t> Handshake();
  absl::StatusOr<std::uint32_t> Step();
  void End(absl::StatusOr<Caller> result);

  EventLoop& loop_;
  Connection connection_;
  TlsContext* const tls_;
  Done done_;
  EventLoop::Id watch_ = 0;
  EventLoop::Id timer_ = 0;
  std::vector<char> header_;
  bool has_address_ = false;
  std::unique_ptr<TlsStream> tls_stream_;
};

}  // namespace ccst::server
