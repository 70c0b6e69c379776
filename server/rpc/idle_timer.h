#pragma once

#include <functional>
#include <memory>

#include "absl/time/time.h"

namespace ccst::server {

/// Tells when nothing has come for a while. One alarm of gRPC's is set per `limit`, however often
/// Start() and Stop() are called. Thread-safe; destroying it stops it.
class IdleTimer {
 public:
  /// `on_idle` is called on one of gRPC's threads, at most once; it may still be under way when
  /// Stop() or the destructor returns.
  IdleTimer(absl::Duration limit, std::function<void()> on_idle);
  ~IdleTimer();
  IdleTimer(const IdleTimer&) = delete;
  IdleTimer& operator=(const IdleTimer&) = delete;

  /// Waiting begins, anew.
  void Start();
  /// Something came.
  void Stop();

 private:
  struct State;
  const std::shared_ptr<State> state_;
};

}  // namespace ccst::server
