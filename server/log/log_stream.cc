#include "server/log/log_stream.h"

#include <algorithm>
#include <cerrno>
#include <climits>

#include <fcntl.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

namespace ccst::server {
namespace {

bool IsWritable(int file, int timeout_ms) {
  pollfd wanted = {.fd = file, .events = POLLOUT, .revents = 0};
  return poll(&wanted, 1, timeout_ms) == 1;
}

}  // namespace

LogStream::LogStream(int file, std::size_t max_waiting)
    : given_(file), file_(file), max_waiting_(max_waiting) {
  struct stat info = {};
  if (fstat(file, &info) != 0) return;
  is_socket_ = S_ISSOCK(info.st_mode);
  if (!S_ISFIFO(info.st_mode) && !S_ISCHR(info.st_mode)) return;
  // Opened anew: O_NONBLOCK on what was given would hold for all who share it, such as a shell.
  const std::string name = "/proc/self/fd/" + std::to_string(file);
  const int own = open(name.c_str(), O_WRONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC);
  may_block_ = own < 0;
  if (own >= 0) file_ = own;
}

LogStream::~LogStream() {
  if (file_ != given_) close(file_);
}

void LogStream::Write(std::string_view line) {
  std::string text(line);
  text += '\n';
  MutexLock lock(mutex_);
  WriteWaiting();
  if (waiting_.empty()) {
    const std::ptrdiff_t taken = Take(text);
    if (taken == static_cast<std::ptrdiff_t>(text.size())) return;
    if (taken < 0) {
      ++lost_;
      return;
    }
    text.erase(0, static_cast<std::size_t>(taken));
  } else if (waiting_bytes_ + text.size() > max_waiting_) {
    ++lost_;
    return;
  }
  waiting_bytes_ += text.size();
  waiting_.push_back(std::move(text));
}

void LogStream::Flush() {
  MutexLock lock(mutex_);
  WriteWaiting();
}

bool LogStream::FlushWithin(std::chrono::milliseconds timeout) {
  const auto deadline = std::chrono::steady_clock::now() + timeout;
  while (true) {
    {
      MutexLock lock(mutex_);
      const std::int64_t lost_before = lost_;
      WriteWaiting();
      if (waiting_.empty()) return lost_ == lost_before;
    }
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(
        deadline - std::chrono::steady_clock::now());
    if (left.count() <= 0 || !IsWritable(file_, static_cast<int>(left.count()))) return false;
  }
}

std::int64_t LogStream::lost_lines() const {
  MutexLock lock(mutex_);
  return lost_;
}

void LogStream::WriteWaiting() {
  while (!waiting_.empty()) {
    std::string& first = waiting_.front();
    const std::ptrdiff_t taken = Take(first);
    if (taken < 0) {
      lost_ += static_cast<std::int64_t>(waiting_.size());
      waiting_.clear();
      waiting_bytes_ = 0;
      return;
    }
    waiting_bytes_ -= static_cast<std::size_t>(taken);
    if (taken < static_cast<std::ptrdiff_t>(first.size())) {
      first.erase(0, static_cast<std::size_t>(taken));
      return;
    }
    waiting_.pop_front();
  }
}

std::ptrdiff_t LogStream::Take(std::string_view text) const {
  std::size_t taken = 0;
  while (taken < text.size()) {
    std::string_view rest = text.substr(taken);
    if (may_block_) {
      // A pipe that is writable takes so much at once.
      if (!IsWritable(file_, 0)) break;
      rest = rest.substr(0, PIPE_BUF);
    }
    const ssize_t written = is_socket_
                                ? send(file_, rest.data(), rest.size(), MSG_DONTWAIT | MSG_NOSIGNAL)
                                : write(file_, rest.data(), rest.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0 && (errno == EAGAIN || errno == EWOULDBLOCK)) break;
    if (written < 0) return -1;
    taken += static_cast<std::size_t>(written);
  }
  return static_cast<std::ptrdiff_t>(taken);
}

}  // namespace ccst::server
