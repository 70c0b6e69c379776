#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "server/auth/peers.h"
#include "server/net/byte_stream.h"
#include "server/net/connection_limits.h"
#include "server/net/event_loop.h"
#include "server/net/frame_guard.h"

namespace ccst::server {

/// Bytes that one end gave and the other does not take yet.
class PendingBytes {
 public:
  bool empty() const { return begin_ == bytes_.size(); }
  std::span<const char> view() const { return std::span(bytes_).subspan(begin_); }
  void Add(std::span<const char> bytes);
  /// Drops the first `count`; gives the memory back with the last.
  void Drop(std::size_t count);

 private:
  std::vector<char> bytes_;
  std::size_t begin_ = 0;
};

/// Carries the bytes of one connection between a caller and gRPC, through a FrameGuard. Holds at
/// most one `room` of bytes each way, and none while both ends keep up. For the thread of its loop
/// alone. gRPC gets its end when HTTP/2 has begun: who says something else costs it nothing.
class Relay : public std::enable_shared_from_this<Relay> {
 public:
  struct Service {
    std::unique_ptr<ByteStream>
        stream;  ///< The socket whose other end gRPC has; null: there is none.
    std::unique_ptr<Peers::Entry> entry;
  };
  struct Ends {
    std::unique_ptr<ByteStream> caller;
    std::unique_ptr<ConnectionLimits::Place> place;
    std::function<Service()> reach_service;  ///< Called once at most.
  };
  /// Times after which a connection ends that does nothing useful [s].
  struct Patience {
    double begin = 10.0;    ///< Until HTTP/2 has begun.
    double request = 60.0;  ///< Until the first request.
    double unread = 60.0;   ///< While the caller does not take what is there for it.
    double farewell = 1.0;  ///< For the caller to close, once gRPC has.
  };
  /// Why it ended before both ends were done, as a word and in words; both empty otherwise.
  struct Reason {
    std::string_view word = {};
    std::string_view text = {};
  };

  /// @param room   memory to move bytes through, of all relays of the loop.
  /// @param ended  called once, last.
  static std::shared_ptr<Relay> Begin(
      EventLoop& loop, Ends ends, std::span<char> room, const Patience& patience,
      std::function<void(const std::shared_ptr<Relay>&, Reason)> ended);

  /// To be called now and then: looks whether its patience is at an end.
  void LookAtTheTime(double now);

  bool has_ended() const { return ended_; }
  /// True when nothing is on its way to the caller any more.
  bool IsQuiet() const {
    return ended_ || service_.stream == nullptr || (service_ended_ && answers_.empty());
  }

 private:
  using Ended = std::function<void(const std::shared_ptr<Relay>&, Reason)>;

  Relay(EventLoop& loop, Ends ends, std::span<char> room, const Patience& patience, Ended ended);
  void Pump();
  // Both: whether anything moved.
  bool PumpRequests(double now);
  bool PumpAnswers(double now);
  bool SendRequests();
  bool SendAnswers();
  // Of bytes that begin behind those of requests_ that may go on.
  bool Judge(std::span<const char> bytes, double now);
  bool ReachService();
  void OnCallerEvents(std::uint32_t events);
  void OnServiceEvents(std::uint32_t events);
  void WaitForEvents();
  void End(Reason reason);

  EventLoop& loop_;
  Ends ends_;
  Service service_;
  const std::span<char> room_;
  const Patience patience_;
  Ended ended_callback_;
  FrameGuard guard_;
  EventLoop::Id caller_watch_ = 0;
  EventLoop::Id service_watch_ = 0;
  EventLoop::Id resume_timer_ = 0;
  PendingBytes requests_;
  std::size_t judged_ = 0;  // So many of requests_ may go on.
  double resume_at_ = 0.0;  // The others may be judged then.
  PendingBytes answers_;
  double begun_at_ = 0.0;
  double unread_since_ = 0.0;    // While answers_ holds some.
  double farewell_since_ = 0.0;  // Once either end has ended.
  bool caller_ended_ = false;
  bool service_ended_ = false;
  bool caller_hung_up_ = false;
  bool said_goodbye_to_service_ = false;
  bool said_goodbye_to_caller_ = false;
  bool pump_is_posted_ = false;
  bool ended_ = false;
};

}  // namespace ccst::server
