#pragma once

#include <functional>
#include <string>

#include "server/base/clock.h"

namespace ccst::server {

/// A clock whose time of day does not follow `clock` where that jumps, against the seconds that
/// have passed: it goes on as before until the new time has stood for an hour. What decides by the
/// time of day when something may be dropped is then not led astray by a machine that is a month
/// ahead for five seconds. Small corrections, up to ten seconds at once, are followed. Thread-safe.
/// @param report  is told when a jump is not followed, and when it is
Clock HoldJumps(const Clock& clock, std::function<void(const std::string&)> report);

}  // namespace ccst::server
