#pragma once

#include <atomic>
#include <cstdint>

namespace ccst::server {

/// Lines of the log on standard error that nobody will read, since the start: the process has one
/// standard error, whoever writes there and whoever tells of it.
inline std::atomic<std::int64_t> lost_log_lines = 0;

}  // namespace ccst::server
