#include "server/net/relay.h"

#include <cstdint>
#include <utility>

#include <sys/epoll.h>

namespace ccst::server {
namespace {

// Turns each way before other connections get theirs.
constexpr int kTurns = 8;

}  // namespace

void PendingBytes::Add(std::span<const char> bytes) {
  bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
}

void PendingBytes::Drop(std::size_t count) {
  begin_ += count;
  if (!empty()) return;
  std::vector<char>().swap(bytes_);
  begin_ = 0;
}

std::shared_ptr<Relay> Relay::Begin(EventLoop& loop, Ends ends, std::span<char> room,
                                    const Patience& patience, Ended ended) {
  std::shared_ptr<Relay> relay(new Relay(loop, std::move(ends), room, patience, std::move(ended)));
  // Of its loop: the functions go with the watches, and those with the end.
  relay->caller_watch_ =
      loop.Watch(relay->ends_.caller->descriptor(), 0,
                 [relay](std::uint32_t events) { relay->OnCallerEvents(events); });
  relay->Pump();
  return relay;
}

Relay::Relay(EventLoop& loop, Ends ends, std::span<char> room, const Patience& patience,
             Ended ended)
    : loop_(loop),
      ends_(std::move(ends)),
      room_(room),
      patience_(patience),
      ended_callback_(std::move(ended)),
      guard_([this](double now) { return ends_.place->TakeReset(now); }),
      begun_at_(EventLoop::Now()) {}

void Relay::OnCallerEvents(std::uint32_t events) {
  const bool is_broken = (events & EPOLLERR) != 0 || (events & EPOLLHUP) != 0;
  if ((events & EPOLLRDHUP) != 0) caller_hung_up_ = true;
  // Who goes while it is being slowed down is not waited for.
  if (is_broken || (caller_hung_up_ && EventLoop::Now() < resume_at_)) {
    End({});
    return;
  }
  Pump();
}

void Relay::OnServiceEvents(std::uint32_t events) {
  // Reported again and again; what is left there is read as the caller takes it.
  if ((events & (EPOLLHUP | EPOLLERR)) != 0) loop_.Forget(std::exchange(service_watch_, 0));
  Pump();
}

void Relay::Pump() {
  if (ended_) return;
  const double now = EventLoop::Now();
  bool moved = true;
  for (int turn = 0; moved && turn < kTurns; ++turn) {
    moved = PumpRequests(now);
    if (!ended_ && PumpAnswers(now)) moved = true;
    if (ended_) return;
  }
  if (moved && !pump_is_posted_) {
    pump_is_posted_ = true;
    loop_.Post([self = shared_from_this()] {
      self->pump_is_posted_ = false;
      self->Pump();
    });
  }
  WaitForEvents();
}

bool Relay::Judge(std::span<const char> bytes, double now) {
  const FrameGuard::Verdict verdict = guard_.Inspect(bytes, now);
  if (!verdict.offence.empty()) {
    End({.word = "protocol", .text = verdict.offence});
    return false;
  }
  judged_ += verdict.allowed;
  resume_at_ = verdict.resume_at;
  return true;
}

bool Relay::ReachService() {
  service_ = ends_.reach_service();
  if (service_.stream == nullptr) {
    End({});
    return false;
  }
  service_watch_ = loop_.Watch(
      service_.stream->descriptor(), 0,
      [self = shared_from_this()](std::uint32_t events) { self->OnServiceEvents(events); });
  return true;
}

bool Relay::SendRequests() {
  const Transfer sent = service_.stream->Write(requests_.view().first(judged_));
  if (sent.state == Transfer::State::kSome) {
    requests_.Drop(sent.bytes);
    judged_ -= sent.bytes;
    return true;
  }
  if (sent.state != Transfer::State::kWait) service_ended_ = true;  // Its last words are read yet.
  return false;
}

bool Relay::PumpRequests(double now) {
  if (service_ended_ || said_goodbye_to_caller_) {
    // Nobody takes requests any more; what comes must be read, or closing would throw away what is
    // on its way to the caller.
    requests_ = {};
    judged_ = 0;
    if (caller_ended_) return false;
    const Transfer read = ends_.caller->Read(room_);
    if (read.state == Transfer::State::kBroken) End({});
    if (read.state == Transfer::State::kEnded) caller_ended_ = true;
    return read.state == Transfer::State::kSome;
  }
  const bool has_service = service_.stream != nullptr;
  if (!requests_.empty() && has_service) {
    if (judged_ == 0) {
      if (now < resume_at_) return false;
      if (!Judge(requests_.view(), now) || judged_ == 0) return false;
    }
    return SendRequests();
  }
  if (caller_ended_) {
    if (!has_service) {
      End({});
    } else if (!std::exchange(said_goodbye_to_service_, true)) {
      service_.stream->FinishWriting();
    }
    return false;
  }
  const Transfer read = ends_.caller->Read(room_);
  switch (read.state) {
    case Transfer::State::kSome:
      break;
    case Transfer::State::kWait:
      return false;
    case Transfer::State::kEnded:
      caller_ended_ = true;
      farewell_since_ = now;
      return true;
    case Transfer::State::kBroken:
      End({});
      return false;
  }
  std::span<const char> bytes = room_.first(read.bytes);
  if (!Judge(bytes, now)) return false;
  if (!has_service) {
    // A few bytes at most: with more HTTP/2 has begun or the connection ended.
    requests_.Add(bytes);
    return !guard_.has_begun() || ReachService();
  }
  if (judged_ > 0) {
    const Transfer sent = service_.stream->Write(bytes.first(judged_));
    if (sent.state == Transfer::State::kSome) {
      bytes = bytes.subspan(sent.bytes);
      judged_ -= sent.bytes;
    } else if (sent.state != Transfer::State::kWait) {
      service_ended_ = true;
      return true;
    }
  }
  if (!bytes.empty()) requests_.Add(bytes);
  return true;
}

bool Relay::SendAnswers() {
  const Transfer sent = ends_.caller->Write(answers_.view());
  if (sent.state == Transfer::State::kBroken) End({});
  if (sent.state != Transfer::State::kSome) return false;
  answers_.Drop(sent.bytes);
  return true;
}

bool Relay::PumpAnswers(double now) {
  if (service_.stream == nullptr) return false;
  if (!answers_.empty()) return SendAnswers();
  if (said_goodbye_to_caller_) {
    if (caller_ended_) End({});
    return false;
  }
  const Transfer read = service_.stream->Read(room_);
  if (read.state == Transfer::State::kWait && !service_ended_) return false;
  if (read.state != Transfer::State::kSome) {
    service_ended_ = true;
    said_goodbye_to_caller_ = true;
    farewell_since_ = now;
    loop_.Forget(std::exchange(service_watch_, 0));
    ends_.caller->FinishWriting();
    return true;
  }
  std::span<const char> bytes = room_.first(read.bytes);
  guard_.InspectAnswer(bytes, now);
  const Transfer sent = ends_.caller->Write(bytes);
  if (sent.state == Transfer::State::kBroken) {
    End({});
    return false;
  }
  bytes = bytes.subspan(sent.bytes);
  if (!bytes.empty()) {
    answers_.Add(bytes);
    unread_since_ = now;
  }
  return true;
}

void Relay::WaitForEvents() {
  const bool reads = (requests_.empty() || service_.stream == nullptr) && !caller_ended_;
  std::uint32_t caller_events = 0;
  if (reads) caller_events |= EPOLLIN;
  if (!reads && !caller_hung_up_ && !caller_ended_) caller_events |= EPOLLRDHUP;
  if (!answers_.empty() || (reads && ends_.caller->ReadWaitsToWrite())) caller_events |= EPOLLOUT;
  loop_.Change(caller_watch_, caller_events);
  std::uint32_t service_events = 0;
  if (answers_.empty()) service_events |= EPOLLIN;
  if (judged_ > 0) service_events |= EPOLLOUT;
  loop_.Change(service_watch_, service_events);
  if (!requests_.empty() && judged_ == 0 && resume_timer_ == 0) {
    resume_timer_ = loop_.RunAt(resume_at_, [self = shared_from_this()] {
      self->resume_timer_ = 0;
      self->Pump();
    });
  }
}

void Relay::LookAtTheTime(double now) {
  if (ended_) return;
  if (!answers_.empty() && now > unread_since_ + patience_.unread) {
    End({.word = "unread", .text = "a caller does not read its answers"});
  } else if ((caller_ended_ || said_goodbye_to_caller_) &&
             now > farewell_since_ + patience_.farewell) {
    End({});
  } else if (!guard_.has_begun() && now > begun_at_ + patience_.begin) {
    End({.word = "silent", .text = "no HTTP/2 in time"});
  } else if (!guard_.has_requests() && now > begun_at_ + patience_.request) {
    End({.word = "silent", .text = "no request in time"});
  }
}

void Relay::End(Reason reason) {
  if (std::exchange(ended_, true)) return;
  const std::shared_ptr<Relay> self = shared_from_this();
  loop_.Forget(caller_watch_);
  loop_.Forget(service_watch_);
  loop_.Cancel(resume_timer_);
  ended_callback_(self, reason);  // Before the caller can see it.
  service_ = {};
  ends_ = {};
}

}  // namespace ccst::server
