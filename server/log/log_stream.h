#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <string>
#include <string_view>

#include "server/base/mutex.h"

namespace ccst::server {

/// Lines to a file descriptor that somebody may read slowly, or not at all, or close: a server must
/// not wait for who reads its log. What a pipe, a terminal or a socket does not take at once waits
/// in memory, bounded; what does not fit there is lost and counted. Thread-safe.
class LogStream {
 public:
  /// @param file         open for writing, as standard error is; stays open and is not changed.
  /// @param max_waiting  bytes of lines that may wait
  explicit LogStream(int file, std::size_t max_waiting = std::size_t{1} << 20);
  ~LogStream();
  LogStream(const LogStream&) = delete;
  LogStream& operator=(const LogStream&) = delete;

  /// Writes `line` and its end after those that wait. Does not block, but on a regular file whose
  /// disk hangs.
  void Write(std::string_view line);
  /// Writes what waits, as far as it is taken; called now and then.
  void Flush();
  /// Flushes until nothing waits; false when `timeout` passed before, or nobody can read any more.
  bool FlushWithin(std::chrono::milliseconds timeout);

  /// Lines that nobody will read, since the start.
  std::int64_t lost_lines() const;

 private:
  // Bytes taken, 0 when none can be just now; -1 when nothing will ever be taken.
  std::ptrdiff_t Take(std::string_view text) const;
  void WriteWaiting() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);

  const int given_;
  int file_;  // `given_`, or the same file opened anew so that it does not block.
  bool is_socket_ = false;
  bool may_block_ = false;  // Ask first, and write little.
  const std::size_t max_waiting_;

  mutable Mutex mutex_;
  std::deque<std::string> waiting_ ABSL_GUARDED_BY(mutex_);  // The first may be the rest of a line.
  std::size_t waiting_bytes_ ABSL_GUARDED_BY(mutex_) = 0;
  std::int64_t lost_ ABSL_GUARDED_BY(mutex_) = 0;
};

}  // namespace ccst::server
