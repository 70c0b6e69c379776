#pragma once

#include <memory>
#include <string>
#include <vector>

#include <sys/types.h>

#include "absl/status/statusor.h"

namespace ccst::interleavings {

/// A `ccst-server` of its own on free ports of the loopback interface.
class ServerProcess {
 public:
  /// @param program  path of `ccst-server`.
  /// @param flags    beside those for the ports.
  /// @errors INTERNAL when it cannot be started or leaves before it listens
  static absl::StatusOr<std::unique_ptr<ServerProcess>> Start(
      const std::string& program, const std::vector<std::string>& flags);
  /// Kills it.
  ~ServerProcess();
  ServerProcess(const ServerProcess&) = delete;
  ServerProcess& operator=(const ServerProcess&) = delete;

  /// HOST:PORT.
  const std::string& address() const { return address_; }

  /// The value of a gauge on its page of metrics.
  /// @errors UNAVAILABLE it does not answer | NOT_FOUND no such gauge
  absl::StatusOr<double> Gauge(const std::string& name) const;

 private:
  explicit ServerProcess(pid_t process) : process_(process) {}

  const pid_t process_;
  std::string address_;
  std::string metrics_address_;
};

}  // namespace ccst::interleavings
