#include "server/net/event_loop.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdint>

#include <pthread.h>
#include <sys/epoll.h>
#include <sys/eventfd.h>

namespace ccst::server {
namespace {

constexpr EventLoop::Id kWakeId = 0;
constexpr std::size_t kEventsAtOnce = 64;
constexpr double kLongestWaitSeconds = 1.0;
constexpr double kMillisecondsPerSecond = 1000.0;

bool Control(int epoll, int operation, int descriptor, EventLoop::Id id, std::uint32_t events) {
  epoll_event event = {};
  event.events = events;
  event.data.u64 = id;
  return epoll_ctl(epoll, operation, descriptor, &event) == 0;
}

}  // namespace

absl::StatusOr<std::unique_ptr<EventLoop>> EventLoop::Start() {
  FileDescriptor epoll(epoll_create1(EPOLL_CLOEXEC));
  FileDescriptor wake(eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK));
  if (!epoll.is_open() || !wake.is_open() ||
      !Control(epoll.get(), EPOLL_CTL_ADD, wake.get(), kWakeId, EPOLLIN)) {
    return absl::UnavailableError("the system has no descriptors left to listen with");
  }
  return std::unique_ptr<EventLoop>(new EventLoop(std::move(epoll), std::move(wake)));
}

EventLoop::EventLoop(FileDescriptor epoll, FileDescriptor wake)
    : epoll_(std::move(epoll)), wake_(std::move(wake)), thread_([this] { Run(); }) {}

EventLoop::~EventLoop() { Stop(); }

void EventLoop::Stop() {
  if (!thread_.joinable()) return;
  {
    const MutexLock lock(mutex_);
    stopped_ = true;
  }
  eventfd_write(wake_.get(), 1);
  thread_.join();
}

double EventLoop::Now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

void EventLoop::Post(std::function<void()> task) {
  {
    const MutexLock lock(mutex_);
    posted_.push_back(std::move(task));
  }
  eventfd_write(wake_.get(), 1);
}

EventLoop::Id EventLoop::Watch(int descriptor, std::uint32_t events,
                               std::function<void(std::uint32_t)> on_events) {
  const Id id = next_id_++;
  if (!Control(epoll_.get(), EPOLL_CTL_ADD, descriptor, id, events)) return 0;
  watched_[id] = {
      .descriptor = descriptor,
      .events = events,
      .on_events = std::make_shared<std::function<void(std::uint32_t)>>(std::move(on_events))};
  return id;
}

void EventLoop::Change(Id watch, std::uint32_t events) {
  const auto found = watched_.find(watch);
  if (found == watched_.end() || found->second.events == events) return;
  found->second.events = events;
  Control(epoll_.get(), EPOLL_CTL_MOD, found->second.descriptor, watch, events);
}

void EventLoop::Forget(Id watch) {
  const auto found = watched_.find(watch);
  if (found == watched_.end()) return;
  epoll_ctl(epoll_.get(), EPOLL_CTL_DEL, found->second.descriptor, nullptr);
  watched_.erase(found);
}

EventLoop::Id EventLoop::RunAt(double seconds, std::function<void()> task) {
  const Id id = next_id_++;
  timers_[{seconds, id}] = std::move(task);
  timer_times_[id] = seconds;
  return id;
}

void EventLoop::Cancel(Id timer) {
  const auto found = timer_times_.find(timer);
  if (found == timer_times_.end()) return;
  timers_.erase({found->second, timer});
  timer_times_.erase(found);
}

int EventLoop::MillisecondsToWait() const {
  if (timers_.empty()) return static_cast<int>(kLongestWaitSeconds * kMillisecondsPerSecond);
  const double seconds = std::clamp(timers_.begin()->first.first - Now(), 0.0, kLongestWaitSeconds);
  return static_cast<int>(std::ceil(seconds * kMillisecondsPerSecond));
}

void EventLoop::RunPosted() {
  std::vector<std::function<void()>> tasks;
  {
    const MutexLock lock(mutex_);
    tasks.swap(posted_);
  }
  for (const auto& task : tasks) task();
}

void EventLoop::RunTimers() {
  const double now = Now();
  while (!timers_.empty() && timers_.begin()->first.first <= now) {
    const auto task = std::move(timers_.begin()->second);
    timer_times_.erase(timers_.begin()->first.second);
    timers_.erase(timers_.begin());
    task();
  }
}

void EventLoop::Run() {
  // Who writes to a connection that is gone learns it from the call, not by dying.
  sigset_t broken_pipe;
  sigemptyset(&broken_pipe);
  sigaddset(&broken_pipe, SIGPIPE);
  pthread_sigmask(SIG_BLOCK, &broken_pipe, nullptr);
  std::array<epoll_event, kEventsAtOnce> events = {};
  while (true) {
    const int count = epoll_wait(epoll_.get(), events.data(), kEventsAtOnce, MillisecondsToWait());
    for (int i = 0; i < count; ++i) {
      const epoll_event& event = events[static_cast<std::size_t>(i)];
      if (event.data.u64 == kWakeId) {
        eventfd_t ignored = 0;
        eventfd_read(wake_.get(), &ignored);
        continue;
      }
      const auto found = watched_.find(event.data.u64);
      if (found == watched_.end()) continue;  // Forgotten since.
      const auto on_events = found->second.on_events;
      (*on_events)(event.events);
    }
    RunPosted();
    RunTimers();
    const MutexLock lock(mutex_);
    if (stopped_) return;
  }
}

}  // namespace ccst::server
