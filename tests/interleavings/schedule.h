#pragma once

#include <condition_variable>
#include <cstdint>
#include <map>
#include <mutex>
#include <random>
#include <string>
#include <string_view>
#include <utility>

namespace ccst::interleavings {

/// On which side of a call a thread is.
enum class Side { kBefore, kAfter };

/// Varies how threads interleave. Each one that comes to a boundary, before or after a call, goes
/// on at once, or is held until others have passed some boundaries, so that much may happen between
/// two of its steps, or until another comes to the same boundary, so that both take the next step
/// together. Nobody is held longer than a few milliseconds, as the others may be waiting for that
/// very thread. The seed steers what is drawn; the system's scheduler decides the rest.
/// Thread-safe.
class Schedule {
 public:
  explicit Schedule(std::uint64_t seed) : random_(seed) {}

  void Pass(std::string_view call, Side side);

  /// From now on nobody is held.
  void Release();

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::mt19937_64 random_;
  bool released_ = false;
  std::int64_t passed_ = 0;
  int held_ = 0;
  std::map<std::pair<std::string, Side>, std::int64_t> arrived_;  // At each boundary.
};

}  // namespace ccst::interleavings
