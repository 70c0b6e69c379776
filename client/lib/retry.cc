#include "client/lib/retry.h"

#include <algorithm>
#include <cmath>
#include <condition_variable>
#include <mutex>
#include <random>
#include <utility>

#include "client/lib/grpc_error.h"
#include "core/base/status.h"

namespace ccst {
namespace {

constexpr int kAttempts = 3;
constexpr double kFirstSeconds = 0.2;  // Doubled for each further attempt.
constexpr double kMaxSeconds = 5.0;
constexpr double kJitter = 0.25;  // Share added at most, so that clients do not come back at once.

double SecondsToWait(int attempts, const absl::Status& status) {
  const double backoff = kFirstSeconds * std::exp2(std::min(attempts, 16) - 1);
  const double seconds =
      std::min(kMaxSeconds, std::max(backoff, RetryDelaySeconds(status).value_or(0.0)));
  std::random_device random;
  return seconds * (1.0 + std::uniform_real_distribution<double>(0.0, kJitter)(random));
}

}  // namespace

absl::Status StoppedError() {
  return MakeError(absl::StatusCode::kCancelled, ErrorReason::kCancelled, "cancelled");
}

Retry::Retry(std::stop_token stop, double patience_seconds)
    : stop_(std::move(stop)), patience_(patience_seconds) {}

void Retry::Heard() {
  has_answered_ = true;
  last_heard_ = std::chrono::steady_clock::now();
  attempts_ = 0;
}

absl::Status Retry::Wait(const absl::Status& status) {
  if (stop_.stop_requested()) return StoppedError();
  if (!absl::IsUnavailable(status)) return status;
  ++attempts_;
  const bool is_patient =
      has_answered_ && std::chrono::steady_clock::now() - last_heard_ < patience_;
  if (attempts_ >= kAttempts && !is_patient) return status;
  std::mutex mutex;
  std::condition_variable_any never;
  std::unique_lock lock(mutex);
  never.wait_for(lock, stop_, std::chrono::duration<double>(SecondsToWait(attempts_, status)),
                 [] { return false; });
  return stop_.stop_requested() ? StoppedError() : absl::OkStatus();
}

}  // namespace ccst
