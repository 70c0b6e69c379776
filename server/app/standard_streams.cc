#include "server/app/standard_streams.h"

#include <array>
#include <csignal>
#include <string>
#include <string_view>

#include <fcntl.h>
#include <unistd.h>

namespace ccst::server {
namespace {

// Whether something that is no stream has the number of one: libraries open descriptors for their
// own events before main() begins, and these take the lowest numbers that are free.
bool IsTaken(int stream) {
  std::array<char, 32> target = {};
  const std::string link = "/proc/self/fd/" + std::to_string(stream);
  const ssize_t length = readlink(link.c_str(), target.data(), target.size());
  constexpr std::string_view kNoFile = "anon_inode:";
  return length > 0 &&
         std::string_view(target.data(), static_cast<std::size_t>(length)).starts_with(kNoFile);
}

// Starts the program anew with /dev/null for the streams that were taken; returns only where that
// is impossible. A library would go on using its descriptor, so it cannot just be closed.
void StartAnew(char** argv) {
  const int null = open("/dev/null", O_RDWR);
  for (int stream = STDIN_FILENO; stream <= STDERR_FILENO; ++stream) {
    if (IsTaken(stream)) dup2(null, stream);
  }
  execv("/proc/self/exe", argv);
}

}  // namespace

void SecureStandardStreams(char** argv) {
  std::signal(SIGPIPE, SIG_IGN);
  // open() takes the lowest number that is free.
  int file = 0;
  while (file >= 0 && file <= STDERR_FILENO) file = open("/dev/null", O_RDWR);
  if (file > STDERR_FILENO) close(file);
  if (IsTaken(STDIN_FILENO) || IsTaken(STDOUT_FILENO) || IsTaken(STDERR_FILENO)) StartAnew(argv);
}

}  // namespace ccst::server
