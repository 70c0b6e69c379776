#pragma once

#include <string_view>

namespace ccst {

/// True when `address` (HOST:PORT, or HOST) is certain to stay on this machine: `localhost`,
/// 127.0.0.0/8 or `[::1]`. Names are not looked up, so any other is false.
bool IsLoopback(std::string_view address);

}  // namespace ccst
