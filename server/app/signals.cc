#include "server/app/signals.h"

#include <csignal>
#include <cstdlib>

#include <pthread.h>

namespace ccst::server {
namespace {

// Wakes the thread when the object goes away.
constexpr int kWake = SIGUSR1;
// Exit status of a process that was told twice.
constexpr int kAtOnceStatus = 1;

sigset_t Watched() {
  sigset_t set;
  sigemptyset(&set);
  sigaddset(&set, SIGTERM);
  sigaddset(&set, SIGINT);
  sigaddset(&set, kWake);
  // Under nohup a terminal that goes away shall not matter, and a signal that is blocked is not
  // ignored any more.
  struct sigaction hangup = {};
  if (sigaction(SIGHUP, nullptr, &hangup) == 0 && hangup.sa_handler != SIG_IGN) {
    sigaddset(&set, SIGHUP);
  }
  return set;
}

}  // namespace

Signals::Signals() {
  const sigset_t set = Watched();
  pthread_sigmask(SIG_BLOCK, &set, nullptr);
  thread_ = std::thread([this] { Listen(); });
}

Signals::~Signals() {
  {
    const std::lock_guard lock(mutex_);
    closed_ = true;
  }
  pthread_kill(thread_.native_handle(), kWake);
  thread_.join();
}

void Signals::Wait() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return received_ > 0; });
}

void Signals::Listen() {
  const sigset_t set = Watched();
  while (true) {
    int signal = 0;
    if (sigwait(&set, &signal) != 0) continue;
    const std::lock_guard lock(mutex_);
    if (closed_) return;
    if (signal == kWake) continue;
    if (++received_ > 1) std::_Exit(kAtOnceStatus);
    changed_.notify_all();
  }
}

}  // namespace ccst::server
