#pragma once

#include <array>
#include <atomic>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_set>
#include <vector>

#include "absl/status/statusor.h"
#include "server/auth/peers.h"
#include "server/auth/tls_files.h"
#include "server/base/mutex.h"
#include "server/net/arrival.h"
#include "server/net/complaints.h"
#include "server/net/connection_limits.h"
#include "server/net/descriptor_limit.h"
#include "server/net/event_loop.h"
#include "server/net/listener.h"
#include "server/net/relay.h"
#include "server/net/tls_context.h"

namespace ccst::server {

/// Where and from whom connections are taken.
struct GateOptions {
  std::string listen;        ///< HOST:PORT; port 0 picks a free one.
  std::string proxy_socket;  ///< Path of a Unix socket for a proxy; empty: none.
  TlsPaths tls;              ///< Empty paths: no TLS.
  int max_connections = 2048;
  int max_connections_per_address = 256;
  double arrival_seconds = 10.0;  ///< For a TLS handshake, and what a proxy says before it.
  Relay::Patience patience;
};

/// Accepts connections, in place of gRPC, whose own listener gives up for ever when descriptors run
/// out once: bounds them, speaks TLS, watches what they send (FrameGuard), and hands them on as
/// local sockets whose names are those of `Peers`.
///
/// Descriptors: three a connection. Threads: one for arrivals, so that handshakes do not hold up
/// who is there, and kRelayLoops for the others.
class ConnectionGate {
 public:
  static constexpr int kDescriptorsPerConnection = 3;
  static constexpr int kRelayLoops = 2;

  struct Dependencies {
    Peers& peers;  ///< Outlives the gate.
    /// Takes a connected socket; false when it did not.
    std::function<bool(int socket)> hand_over;
    /// One connection came to nothing, for this reason: one of a few fixed words.
    std::function<void(std::string_view reason)> count;
    std::function<void(const std::string& line)> report;
  };

  /// Listens, without accepting yet; callers wait in the kernel.
  /// @errors UNAVAILABLE an address cannot be had | those of TlsContext::Load()
  static absl::StatusOr<std::unique_ptr<ConnectionGate>> Open(GateOptions options,
                                                              Dependencies dependencies);
  /// Ends all connections.
  ~ConnectionGate();
  ConnectionGate(const ConnectionGate&) = delete;
  ConnectionGate& operator=(const ConnectionGate&) = delete;

  /// Accepts from now on.
  void Accept();
  /// Accepts nobody any more. Once it returned nothing is handed over. A second time it
  /// does nothing. Not on two threads.
  void Close();
  /// Waits until callers have what was on its way to them, at most `seconds`. After Close(), and
  /// after gRPC closed its ends.
  void WaitUntilQuiet(double seconds);

  /// HOST:PORT with the port really listened on.
  const std::string& address() const { return address_; }
  /// Connections open now, and as many as there may be.
  int open() const { return limits_.open(); }
  int max_connections() const { return limits_.max_connections(); }

  /// Where this machine reaches the gate: loopback where it listens at every address.
  const sockaddr_storage& own_address() const { return own_address_; }
  bool has_tls() const { return tls_ != nullptr; }
  /// From now on a connection from that socket address of this machine is the server's own: it
  /// counts towards no limit and needs no certificate.
  void ExpectOwn(const MachineAddress& from) ABSL_LOCKS_EXCLUDED(mutex_);
  void ForgetOwn() ABSL_LOCKS_EXCLUDED(mutex_);

 private:
  // A loop and what runs on it.
  struct RelayLoop {
    std::vector<char> room;
    std::unordered_set<std::shared_ptr<Relay>> relays;
    std::unique_ptr<EventLoop> loop;  // Last: its thread ends first.
  };
  struct Door {
    FileDescriptor socket;
    bool for_proxy = false;
    EventLoop::Id watch = 0;
  };

  ConnectionGate(GateOptions options, Dependencies dependencies, std::unique_ptr<TlsContext> tls);
  absl::Status Listen();
  void AcceptSome(Door& door);
  void Rest(Door& door);
  void Admit(FileDescriptor socket, const MachineAddress& address, bool for_proxy);
  bool IsOwn(const MachineAddress& address) ABSL_LOCKS_EXCLUDED(mutex_);
  void OnArrival(absl::StatusOr<Arrival::Caller> caller);
  void StartRelay(RelayLoop& on, Arrival::Caller caller);
  Relay::Service HandOver(const Peer& peer);
  void Tick(RelayLoop& on);
  void Refuse(std::string_view reason, std::string_view detail);
  void Refuse(std::string_view reason, const absl::Status& why);

  const GateOptions options_;
  const Dependencies dependencies_;
  Complaints complaints_;
  ConnectionLimits limits_;
  const std::unique_ptr<TlsContext> tls_;  // Of the door's thread.
  SpareDescriptor spare_;                  // Likewise.
  std::string address_;
  sockaddr_storage own_address_ = {};
  std::vector<Door> doors_;
  bool was_closed_ = false;
  std::atomic<bool> is_closed_ = false;
  std::size_t next_loop_ = 0;
  Mutex mutex_;
  std::optional<MachineAddress> own_ ABSL_GUARDED_BY(mutex_);
  std::array<RelayLoop, kRelayLoops> relay_loops_;
  std::unique_ptr<EventLoop> door_loop_;  // Last: its thread ends first.
};

}  // namespace ccst::server
