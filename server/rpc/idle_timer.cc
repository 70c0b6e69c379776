#include "server/rpc/idle_timer.h"

#include <chrono>
#include <utility>

#include <grpc/support/time.h>
#include <grpcpp/alarm.h>

#include "server/base/mutex.h"

namespace ccst::server {
namespace {

using SteadyClock = std::chrono::steady_clock;

gpr_timespec After(SteadyClock::duration wait) {
  const auto nanos = std::chrono::duration_cast<std::chrono::nanoseconds>(wait).count();
  return gpr_time_add(gpr_now(GPR_CLOCK_MONOTONIC), gpr_time_from_nanos(nanos, GPR_TIMESPAN));
}

}  // namespace

struct IdleTimer::State : std::enable_shared_from_this<State> {
  State(absl::Duration limit_in, std::function<void()> on_idle_in)
      : limit(absl::ToChronoNanoseconds(limit_in)), on_idle(std::move(on_idle_in)) {}

  void Arm() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex) {
    alarm = std::make_unique<grpc::Alarm>();
    alarm->Set(After(deadline - SteadyClock::now()),
               [self = shared_from_this()](bool ok) { self->OnAlarm(ok); });
  }

  void OnAlarm(bool ok) {
    {
      MutexLock lock(mutex);
      // Gone before another is set, which an alarm must not be while its function runs; and the
      // function, which it owns, holds this state.
      alarm.reset();
      if (!ok || !waiting) return;
      if (SteadyClock::now() < deadline) return Arm();
      waiting = false;
    }
    on_idle();
  }

  const SteadyClock::duration limit;
  const std::function<void()> on_idle;
  Mutex mutex;
  SteadyClock::time_point deadline ABSL_GUARDED_BY(mutex);
  bool waiting ABSL_GUARDED_BY(mutex) = false;
  std::unique_ptr<grpc::Alarm> alarm ABSL_GUARDED_BY(mutex);  // Null: none is set.
};

IdleTimer::IdleTimer(absl::Duration limit, std::function<void()> on_idle)
    : state_(std::make_shared<State>(limit, std::move(on_idle))) {}

IdleTimer::~IdleTimer() {
  std::unique_ptr<grpc::Alarm> cancelled;  // Outside the lock, which its function takes.
  MutexLock lock(state_->mutex);
  state_->waiting = false;
  cancelled = std::move(state_->alarm);
}

void IdleTimer::Start() {
  MutexLock lock(state_->mutex);
  state_->waiting = true;
  state_->deadline = SteadyClock::now() + state_->limit;
  if (state_->alarm == nullptr) state_->Arm();
}

void IdleTimer::Stop() {
  MutexLock lock(state_->mutex);
  state_->waiting = false;
}

}  // namespace ccst::server
