#pragma once

#include <functional>
#include <string>
#include <thread>

#include "absl/status/status.h"
#include "server/base/mutex.h"
#include "server/net/gate.h"

namespace ccst::server {

/// Asks for health through the server's own port, as a caller would: a new connection, TLS where
/// callers need it, HTTP/2, gRPC. Whatever the answer is, the way there is open.
/// Blocks for at most `seconds`.
/// @errors UNAVAILABLE  why no answer came
absl::Status ReachOneself(ConnectionGate& gate, double seconds);

/// Looks now and then whether the server can be reached, on a thread of its own.
class SelfCheck {
 public:
  struct Options {
    double interval_seconds = 10.0;  ///< From one look to the next.
    double patience_seconds = 5.0;   ///< Of one look.
    int failures = 6;                ///< In a row, until it counts.
  };

  /// @param reach           looks once: ReachOneself().
  /// @param on_unreachable  is told once, with the reason of the last failure.
  SelfCheck(const Options& options, std::function<absl::Status(double seconds)> reach,
            std::function<void(const std::string& reason)> on_unreachable);
  /// Waits for a look under way.
  ~SelfCheck();
  SelfCheck(const SelfCheck&) = delete;
  SelfCheck& operator=(const SelfCheck&) = delete;

 private:
  void Run();

  const Options options_;
  const std::function<absl::Status(double)> reach_;
  const std::function<void(const std::string&)> on_unreachable_;
  Mutex mutex_;
  StoppableCondVar changed_;
  bool stopped_ ABSL_GUARDED_BY(mutex_) = false;
  std::thread thread_;
};

}  // namespace ccst::server
