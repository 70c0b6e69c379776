#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <unordered_map>

#include "absl/status/statusor.h"
#include "server/base/mutex.h"
#include "server/net/rate_bucket.h"

namespace ccst::server {

/// How many connections there may be, in all and of one address, and how often one address may
/// reset streams, over all its connections. Thread-safe.
class ConnectionLimits {
 public:
  /// Resets of one address: so that who connects anew for every burst gains nothing. Twenty
  /// connections may be at their own rate.
  static constexpr double kResetBurst = 4096;
  static constexpr double kResetsPerSecond = 2000;

  /// Both at least 1.
  ConnectionLimits(int max_connections, int max_per_address);
  ~ConnectionLimits();

  /// The place of one connection, for as long as it lives.
  class Place;

  /// A place that no address is charged for yet.
  /// @errors RESOURCE_EXHAUSTED  there are as many connections as there may be
  absl::StatusOr<std::unique_ptr<Place>> Take() ABSL_LOCKS_EXCLUDED(mutex_);
  /// A place for the server's own connection, which there always is.
  std::unique_ptr<Place> TakeBeyond() ABSL_LOCKS_EXCLUDED(mutex_);

  int open() const ABSL_LOCKS_EXCLUDED(mutex_);
  int max_connections() const { return max_connections_; }
  /// Addresses that are kept in mind: at most twice as many as connections, and one.
  std::size_t known_addresses() const ABSL_LOCKS_EXCLUDED(mutex_);

 private:
  struct Address {
    int open = 0;
    RateBucket resets = RateBucket(kResetsPerSecond, kResetBurst);
  };

  void ForgetQuietAddresses(double now) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);

  const int max_connections_;
  const int max_per_address_;
  mutable Mutex mutex_;
  int open_ ABSL_GUARDED_BY(mutex_) = 0;
  std::unordered_map<std::string, Address> addresses_ ABSL_GUARDED_BY(mutex_);
};

/// Must not outlive its limits.
class ConnectionLimits::Place {
 public:
  explicit Place(ConnectionLimits& limits) : limits_(limits) {}
  ~Place();
  Place(const Place&) = delete;
  Place& operator=(const Place&) = delete;

  /// Charges `network` for the place, at most once.
  /// @errors RESOURCE_EXHAUSTED  it has as many connections as one may have
  absl::Status Charge(const std::string& network, double now);
  /// From when on the address may reset another stream; `now` when nobody is charged.
  double TakeReset(double now);

 private:
  ConnectionLimits& limits_;
  std::string network_;  // Empty: nobody is charged.
};

}  // namespace ccst::server
