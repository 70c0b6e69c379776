#pragma once

#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

#include "absl/status/statusor.h"
#include "core/base/interrupt.h"

namespace ccst::cli {

/// Returns what `read` returns. Readers cannot be interrupted: at the `deadline` one that is still
/// at work is left behind on its thread. Whoever gets that error has to end the process with
/// std::_Exit(), which waits for no thread. Without a deadline `read` runs on this thread.
/// @errors those of `read` | DEADLINE_EXCEEDED TIME_LIMIT_EXCEEDED
template <typename T>
absl::StatusOr<T> ReadWithin(std::optional<ccst::Interrupt::Clock::time_point> deadline,
                             std::function<absl::StatusOr<T>()> read) {
  if (!deadline.has_value()) return read();
  struct Reading {
    std::mutex mutex;
    std::condition_variable changed;
    std::optional<absl::StatusOr<T>> result;
  };
  const auto reading = std::make_shared<Reading>();
  std::thread([reading, read = std::move(read)] {
    absl::StatusOr<T> result = read();
    const std::lock_guard lock(reading->mutex);
    reading->result = std::move(result);
    reading->changed.notify_all();
  }).detach();
  std::unique_lock lock(reading->mutex);
  if (reading->changed.wait_until(lock, *deadline, [&] { return reading->result.has_value(); })) {
    return *std::move(reading->result);
  }
  ccst::Interrupt late({}, deadline);
  late.Requested();
  return late.Error("the input was read");
}

}  // namespace ccst::cli
