#include "server/net/gate.h"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <future>
#include <utility>

#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/epoll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include "core/base/status.h"

namespace ccst::server {
namespace {

constexpr std::size_t kRoomBytes = std::size_t{64} << 10;
constexpr int kAcceptedAtOnce = 64;
// After the system had nothing left for another connection.
constexpr double kRestSeconds = 0.1;
constexpr double kTickSeconds = 0.5;
constexpr double kQuietLookSeconds = 0.01;

// So that a machine that is gone does not keep its place for hours.
void SetUp(int socket, const GateOptions& options) {
  const int on = 1;
  const auto milliseconds = static_cast<unsigned int>(options.patience.unread * 1000.0);
  setsockopt(socket, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
  setsockopt(socket, IPPROTO_TCP, TCP_USER_TIMEOUT, &milliseconds, sizeof milliseconds);
}

// Two connected sockets; the name of the first is what gRPC will call the peer of the second.
bool MakePair(const std::string& name, FileDescriptor& ours, FileDescriptor& theirs) {
  std::array<int, 2> pair = {};
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0, pair.data()) != 0) {
    return false;
  }
  ours = FileDescriptor(pair[0]);
  theirs = FileDescriptor(pair[1]);
  // Abstract: it begins with a zero byte, is no file, and goes with the socket.
  sockaddr_un place = {};
  place.sun_family = AF_UNIX;
  std::memcpy(&place.sun_path[1], name.data(), name.size());
  const auto size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + name.size());
  return bind(ours.get(), reinterpret_cast<const sockaddr*>(&place), size) == 0;
}

// Runs `task` on the loop's thread and waits for it.
void RunOn(EventLoop& loop, const std::function<void()>& task) {
  std::promise<void> done;
  loop.Post([&task, &done] {
    task();
    done.set_value();
  });
  done.get_future().wait();
}

// Of who listens at every address this machine's own is loopback.
sockaddr_storage OwnAddressOf(const FileDescriptor& socket) {
  sockaddr_storage address = {};
  socklen_t size = sizeof address;
  getsockname(socket.get(), reinterpret_cast<sockaddr*>(&address), &size);
  if (address.ss_family == AF_INET) {
    auto& ipv4 = reinterpret_cast<sockaddr_in&>(address);
    if (ipv4.sin_addr.s_addr == htonl(INADDR_ANY)) ipv4.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  } else if (address.ss_family == AF_INET6) {
    auto& ipv6 = reinterpret_cast<sockaddr_in6&>(address);
    if (IN6_IS_ADDR_UNSPECIFIED(&ipv6.sin6_addr)) ipv6.sin6_addr = in6addr_loopback;
  }
  return address;
}

std::string_view WordFor(const absl::Status& status) {
  switch (status.code()) {
    case absl::StatusCode::kResourceExhausted:
      return "address";
    case absl::StatusCode::kInvalidArgument:
      return "proxy";
    case absl::StatusCode::kDeadlineExceeded:
      return "silent";
    default:
      return "handshake";
  }
}

}  // namespace

absl::StatusOr<std::unique_ptr<ConnectionGate>> ConnectionGate::Open(GateOptions options,
                                                                     Dependencies dependencies) {
  std::unique_ptr<TlsContext> tls;
  if (!options.tls.certificate.empty()) {
    CCST_ASSIGN_OR_RETURN(tls, TlsContext::Load(options.tls, dependencies.report));
  }
  std::unique_ptr<ConnectionGate> gate(
      new ConnectionGate(std::move(options), std::move(dependencies), std::move(tls)));
  CCST_RETURN_IF_ERROR(gate->Listen());
  return gate;
}

ConnectionGate::ConnectionGate(GateOptions options, Dependencies dependencies,
                               std::unique_ptr<TlsContext> tls)
    : options_(std::move(options)),
      dependencies_(std::move(dependencies)),
      complaints_(dependencies_.count, dependencies_.report),
      limits_(options_.max_connections, options_.max_connections_per_address),
      tls_(std::move(tls)) {}

ConnectionGate::~ConnectionGate() {
  // The thread of arrivals first: it hands on to the others. All end before a loop goes, which
  // tasks reach through these members.
  if (door_loop_ != nullptr) door_loop_->Stop();
  for (RelayLoop& on : relay_loops_) {
    if (on.loop != nullptr) on.loop->Stop();
  }
  door_loop_.reset();
  for (RelayLoop& on : relay_loops_) on.loop.reset();
}

absl::Status ConnectionGate::Listen() {
  CCST_ASSIGN_OR_RETURN(Listener listener, ListenAt(options_.listen));
  address_ = listener.address;
  own_address_ = OwnAddressOf(listener.sockets.front());
  for (FileDescriptor& socket : listener.sockets) doors_.push_back({.socket = std::move(socket)});
  if (!options_.proxy_socket.empty()) {
    CCST_ASSIGN_OR_RETURN(Listener for_proxy, ListenAtPath(options_.proxy_socket));
    doors_.push_back({.socket = std::move(for_proxy.sockets.front()), .for_proxy = true});
  }
  for (RelayLoop& on : relay_loops_) {
    on.room.resize(kRoomBytes);
    CCST_ASSIGN_OR_RETURN(on.loop, EventLoop::Start());
    on.loop->Post([this, &on] { Tick(on); });
  }
  CCST_ASSIGN_OR_RETURN(door_loop_, EventLoop::Start());
  return absl::OkStatus();
}

void ConnectionGate::Accept() {
  door_loop_->Post([this] {
    for (Door& door : doors_) {
      door.watch = door_loop_->Watch(door.socket.get(), EPOLLIN,
                                     [this, &door](std::uint32_t /*events*/) { AcceptSome(door); });
    }
  });
}

void ConnectionGate::Close() {
  if (std::exchange(was_closed_, true)) return;
  RunOn(*door_loop_, [this] {
    is_closed_ = true;
    for (Door& door : doors_) {
      door_loop_->Forget(door.watch);
      door.socket.Close();
    }
  });
  // What arrived before is handed over when they have come to this.
  for (RelayLoop& on : relay_loops_) RunOn(*on.loop, [] {});
  if (!options_.proxy_socket.empty()) unlink(options_.proxy_socket.c_str());
}

void ConnectionGate::AcceptSome(Door& door) {
  for (int i = 0; i < kAcceptedAtOnce; ++i) {
    sockaddr_storage address = {};
    socklen_t size = sizeof address;
    FileDescriptor socket(accept4(door.socket.get(), reinterpret_cast<sockaddr*>(&address), &size,
                                  SOCK_CLOEXEC | SOCK_NONBLOCK));
    if (socket.is_open()) {
      Admit(std::move(socket), MachineAddressOf(address), door.for_proxy);
      continue;
    }
    if (errno == EINTR || errno == ECONNABORTED) continue;
    if (errno == EAGAIN || errno == EWOULDBLOCK) return;
    if (errno == EMFILE || errno == ENFILE) {
      spare_.TurnAway(door.socket.get());
      Refuse("descriptors", "the process has no descriptors left");
    } else {
      Refuse("system", "the system has no room for another one");
    }
    Rest(door);
    return;
  }
}

// Looking again at once would take all of a core until something is given back.
void ConnectionGate::Rest(Door& door) {
  door_loop_->Change(door.watch, 0);
  door_loop_->RunAt(EventLoop::Now() + kRestSeconds,
                    [this, &door] { door_loop_->Change(door.watch, EPOLLIN); });
}

void ConnectionGate::ExpectOwn(const MachineAddress& from) {
  const MutexLock lock(mutex_);
  own_ = from;
}

void ConnectionGate::ForgetOwn() {
  const MutexLock lock(mutex_);
  own_.reset();
}

bool ConnectionGate::IsOwn(const MachineAddress& address) {
  const MutexLock lock(mutex_);
  return own_.has_value() && own_->text == address.text && own_->port == address.port;
}

void ConnectionGate::Admit(FileDescriptor socket, const MachineAddress& address, bool for_proxy) {
  SetUp(socket.get(), options_);
  const bool from_here = !for_proxy && IsOwn(address);
  Arrival::Connection connection;
  connection.socket = std::move(socket);
  connection.address = address;
  connection.from_proxy = for_proxy;
  connection.from_here = from_here;
  if (from_here) {
    connection.place = limits_.TakeBeyond();
  } else {
    auto place = limits_.Take();
    if (!place.ok()) {
      Refuse("all", place.status());
      return;
    }
    connection.place = *std::move(place);
  }
  Arrival::Begin(*door_loop_, std::move(connection), tls_.get(), options_.arrival_seconds,
                 [this](absl::StatusOr<Arrival::Caller> caller) { OnArrival(std::move(caller)); });
}

void ConnectionGate::OnArrival(absl::StatusOr<Arrival::Caller> caller) {
  if (is_closed_) return;
  if (!caller.ok()) {
    Refuse(WordFor(caller.status()), caller.status());
    return;
  }
  RelayLoop& on = relay_loops_[next_loop_++ % kRelayLoops];
  // Shared, as functions must be copyable.
  const auto shared = std::make_shared<Arrival::Caller>(*std::move(caller));
  on.loop->Post([this, &on, shared] { StartRelay(on, std::move(*shared)); });
}

void ConnectionGate::StartRelay(RelayLoop& on, Arrival::Caller caller) {
  const auto relay = Relay::Begin(
      *on.loop,
      {.caller = std::move(caller.stream),
       .place = std::move(caller.place),
       .reach_service = [this, peer = std::move(caller.peer)] { return HandOver(peer); }},
      on.room, options_.patience, [this, &on](const std::shared_ptr<Relay>& ended, auto reason) {
        on.relays.erase(ended);
        if (!reason.word.empty()) Refuse(reason.word, reason.text);
      });
  if (!relay->has_ended()) on.relays.insert(relay);
}

Relay::Service ConnectionGate::HandOver(const Peer& peer) {
  if (is_closed_) return {};
  auto entry = dependencies_.peers.Add(peer);
  FileDescriptor ours;
  FileDescriptor theirs;
  if (!MakePair(entry->name(), ours, theirs)) {
    Refuse("descriptors", "the process has no descriptors left");
    return {};
  }
  if (!dependencies_.hand_over(theirs.get())) return {};
  theirs.Release();
  return {.stream = std::make_unique<ByteStream>(std::move(ours)), .entry = std::move(entry)};
}

void ConnectionGate::Tick(RelayLoop& on) {
  const double now = EventLoop::Now();
  // A copy: who ends leaves the set.
  const std::vector<std::shared_ptr<Relay>> relays(on.relays.begin(), on.relays.end());
  for (const auto& relay : relays) relay->LookAtTheTime(now);
  on.loop->RunAt(now + kTickSeconds, [this, &on] { Tick(on); });
}

void ConnectionGate::WaitUntilQuiet(double seconds) {
  const double end = EventLoop::Now() + seconds;
  while (EventLoop::Now() < end) {
    bool is_quiet = true;
    for (RelayLoop& on : relay_loops_) {
      RunOn(*on.loop, [&on, &is_quiet] {
        is_quiet = is_quiet && std::all_of(on.relays.begin(), on.relays.end(),
                                           [](const auto& relay) { return relay->IsQuiet(); });
      });
    }
    if (is_quiet) return;
    std::this_thread::sleep_for(std::chrono::duration<double>(kQuietLookSeconds));
  }
}

void ConnectionGate::Refuse(std::string_view reason, const absl::Status& why) {
  Refuse(reason, std::string(why.message()));
}

void ConnectionGate::Refuse(std::string_view reason, std::string_view detail) {
  complaints_.Note(reason, detail, EventLoop::Now());
}

}  // namespace ccst::server
