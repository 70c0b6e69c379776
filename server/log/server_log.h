#pragma once

#include <cstdint>
#include <functional>
#include <mutex>
#include <string>
#include <string_view>

#include "absl/time/time.h"

namespace ccst::server {

/// How log lines look.
enum class LogFormat { kText, kJson };

/// One finished request. Holds nothing of what the caller sent but counts and its trace id.
struct RequestRecord {
  std::string method;    ///< For example `Sample`.
  std::string job;       ///< `jobs/{uuid}`; empty when there was none.
  std::string owner;     ///< Who called: printable, without spaces.
  std::string trace_id;  ///< 32 hexadecimal digits; empty when the caller traces nothing.
  std::string code;      ///< For example `OK`, `INVALID_ARGUMENT`.
  std::string reason;    ///< For example `MESH_NOT_MANIFOLD`; empty when OK.
  double seconds = 0.0;
  std::int64_t request_bytes = 0;   ///< Messages received, as encoded.
  std::int64_t response_bytes = 0;  ///< Messages sent, as encoded.
  std::int64_t samples_requested = 0;
  std::int64_t samples_sent = 0;
  std::int64_t messages_sent = 0;
};

/// Writes one line a request and a few about the server itself. Thread-safe.
class ServerLog {
 public:
  /// `write` gets whole lines without their end, one at a time.
  ServerLog(LogFormat format, std::function<absl::Time()> now,
            std::function<void(const std::string&)> write);

  void Request(const RequestRecord& record);
  void Message(std::string_view message);

 private:
  void Write(const std::string& line);

  const LogFormat format_;
  const std::function<absl::Time()> now_;
  std::mutex mutex_;  // Of write_.
  const std::function<void(const std::string&)> write_;
};

}  // namespace ccst::server
