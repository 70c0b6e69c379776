#pragma once

#include <functional>

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

namespace ccst::server {

/// What `run` returns in a process of its own that may start only so many threads, in [0, 100]; -1
/// when it did not return within 20 s. Limits do not hold for root, so as root another user runs
/// it, who has no other process.
inline int WithFewThreads(int threads, const std::function<int()>& run) {
  constexpr unsigned kSeconds = 20;
  constexpr uid_t kFirstUser = 400'000;
  const pid_t child = fork();
  if (child == 0) {
    alarm(kSeconds);
    const bool is_alone = geteuid() != 0 || setuid(kFirstUser + static_cast<uid_t>(getpid())) == 0;
    const rlim_t most = 1 + static_cast<rlim_t>(threads);
    const rlimit limit = {.rlim_cur = most, .rlim_max = most};
    if (!is_alone || setrlimit(RLIMIT_NPROC, &limit) != 0) _exit(101);
    _exit(run());
  }
  int status = -1;
  if (waitpid(child, &status, 0) != child || !WIFEXITED(status)) return -1;
  return WEXITSTATUS(status);
}

}  // namespace ccst::server
