#include "client/cli/interrupt.h"

#include <unistd.h>

#include "client/cli/exit_code.h"

namespace ccst::cli {

Interrupt::Interrupt(const std::string& notice) : notice_("\n" + notice + "\n") {
  sigemptyset(&signals_);
  sigaddset(&signals_, SIGINT);
  sigaddset(&signals_, SIGTERM);
  pthread_sigmask(SIG_BLOCK, &signals_, &before_);
  waiter_ = std::thread([this] { Wait(); });
}

Interrupt::~Interrupt() {
  done_ = true;
  pthread_kill(waiter_.native_handle(), SIGTERM);
  waiter_.join();
  pthread_sigmask(SIG_SETMASK, &before_, nullptr);
}

void Interrupt::Wait() {
  for (;;) {
    int signal = 0;
    if (sigwait(&signals_, &signal) != 0) return;
    if (done_) return;
    if (stop_.stop_requested()) _exit(kCancelled);
    if (signal == SIGINT && isatty(STDERR_FILENO) == 1) {
      [[maybe_unused]] const ssize_t written = write(STDERR_FILENO, notice_.data(), notice_.size());
    }
    stop_.request_stop();
  }
}

}  // namespace ccst::cli
