#pragma once

#include <chrono>
#include <stop_token>

#include "absl/status/status.h"

namespace ccst {

/// The error of a call that was stopped by its caller.
absl::Status StoppedError();

/// Decides whether a call that did not reach the server is made again, and when: three attempts in
/// a row, and as many as fit into `patience_seconds` once the server has answered.
class Retry {
 public:
  /// @param patience_seconds  how long a server that has answered may be away
  explicit Retry(std::stop_token stop, double patience_seconds = 0.0);

  /// The server answered: count from here.
  void Heard();

  /// Waits, at least as long as the server advises. OK: make the call again; else the error to
  /// return: CANCELLED when stopped, `status` when it is not UNAVAILABLE or patience is used up.
  absl::Status Wait(const absl::Status& status);

 private:
  std::stop_token stop_;
  std::chrono::duration<double> patience_;
  bool has_answered_ = false;
  std::chrono::steady_clock::time_point last_heard_;
  int attempts_ = 0;
};

}  // namespace ccst
