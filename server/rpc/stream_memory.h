#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "absl/status/statusor.h"
#include "server/base/mutex.h"

namespace ccst::server {

/// Bounds on the memory of open streams. A stream keeps the message that its reader has not taken
/// yet, as a message and as bytes, however long that takes.
struct StreamLimits {
  std::int64_t most_bytes = std::int64_t{128} << 20;  ///< Of all callers.
  /// A write that the reader has not taken after this long ends the stream [s].
  double longest_write_seconds = 60.0;

  /// Leaves room for others.
  std::int64_t most_bytes_of_caller() const { return most_bytes / 4 * 3; }
};

/// The memory of all open streams, shared out by their largest messages. Thread-safe.
class StreamMemory {
 public:
  /// What one stream has; given back when it is destroyed.
  class Share {
   public:
    Share(StreamMemory& memory, std::string caller, std::int64_t bytes)
        : memory_(&memory), caller_(std::move(caller)), bytes_(bytes) {}
    Share(Share&& other) noexcept;
    Share& operator=(Share&&) = delete;
    ~Share();

   private:
    StreamMemory* memory_;
    std::string caller_;
    std::int64_t bytes_;
  };

  explicit StreamMemory(const StreamLimits& limits) : limits_(limits) {}

  const StreamLimits& limits() const { return limits_; }

  /// Memory for a stream of `caller`.
  /// @errors RESOURCE_EXHAUSTED QUEUE_FULL all is taken, QUOTA_EXCEEDED the caller's part is
  absl::StatusOr<Share> Take(const std::string& caller, std::int64_t bytes);

 private:
  void GiveBack(const std::string& caller, std::int64_t bytes);

  const StreamLimits limits_;
  Mutex mutex_;
  std::int64_t taken_ ABSL_GUARDED_BY(mutex_) = 0;
  std::map<std::string, std::int64_t> by_caller_ ABSL_GUARDED_BY(mutex_);  // None is 0.
};

/// What a stream takes whose messages have at most `message_bytes`: each is kept twice while it is
/// written, and gRPC has its own records of a call.
constexpr std::int64_t StreamBytes(std::int64_t message_bytes) {
  constexpr std::int64_t kOfCall = std::int64_t{32} << 10;
  return kOfCall + 2 * message_bytes;
}

}  // namespace ccst::server
